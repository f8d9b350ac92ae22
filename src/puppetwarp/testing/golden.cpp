#include <puppetwarp/testing/golden.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/base/input_file.h>
#include <puppetwarp/base/output_file.h>
#include <puppetwarp/image/read.h>
#include <puppetwarp/image/write.h>

#include <cstdlib>
#include <limits>
#include <optional>

namespace puppetwarp {

namespace fs = std::filesystem;

namespace {

constexpr int smallest_files = 9;  // of WriteOptions::compression: golden pictures are kept for years

std::string environment(const char* variable) {
    const char* value = std::getenv(variable);
    return value != nullptr ? value : "";
}

fs::path first_named(const fs::path& option, const char* variable, const fs::path& usual) {
    if (!option.empty()) return option;
    const std::string value = environment(variable);
    return value.empty() ? usual : fs::path(value);
}

std::string bytes_of(const fs::path& path) {
    return read_file(path, std::numeric_limits<std::size_t>::max());
}

// Why these pixels are no picture at all; empty when they are.
std::string fault_of(const cv::Mat& pixels) {
    if (pixels.empty()) return "the actual picture is empty";
    const int depth = pixels.depth();
    const bool known = pixels.channels() <= 4 && (depth == CV_8U || depth == CV_16U || depth == CV_32F);
    return known ? "" : "the actual picture is neither 8-bit, 16-bit nor float with 1 to 4 channels";
}

bool can_be_written(const fs::path& path) {
    try {
        output_format(path);
        return true;
    } catch (const InvalidInput&) {
        return false;
    }
}

// Where everything of one comparison is.
struct Places {
    fs::path golden;
    fs::path expected;
    fs::path actual;
    fs::path heat_map;
};

Places places_of(const fs::path& golden, const GoldenOptions& options, const fs::path& usual_folder) {
    Places places;
    places.golden = fs::absolute(first_named(options.golden_folder, "PUPPETWARP_GOLDEN_FOLDER", usual_folder) / golden);
    // Absolute paths and ways out of the folder of golden pictures must not lead out of the output folder.
    fs::path inside;
    for (const fs::path& part : golden.lexically_normal().relative_path()) {
        if (part != "..") inside /= part;
    }
    if (golden.is_absolute()) inside = golden.filename();
    const fs::path stem =
        fs::absolute(first_named(options.output_folder, "PUPPETWARP_IMAGE_TEST_OUTPUT", "image-tests")) /
        inside.parent_path() / inside.stem();
    const fs::path extension = can_be_written(golden) ? golden.extension() : fs::path(".png");
    places.expected = stem.string() + ".expected" + golden.extension().string();
    places.actual = stem.string() + ".actual" + extension.string();
    places.heat_map = stem.string() + ".heatmap.png";
    return places;
}

// The golden picture and what is wrong with the actual one beside it.
struct Finding {
    std::optional<Image> expected;  // none: missing, or cannot be read
    std::string difference;         // empty: none
    bool comparable = false;
};

Finding look_at(const Image& actual, const fs::path& golden, const CompareOptions& options) {
    Finding finding;
    if (!fs::exists(golden)) {
        finding.difference = "there is no golden picture yet";
        return finding;
    }
    try {
        finding.expected = read_image(golden, {.max_pixels = std::numeric_limits<std::int64_t>::max()});
    } catch (const InvalidInput& error) {
        finding.difference = "the golden picture cannot be read: " + error.reason();
        return finding;
    }
    const Comparison comparison = compare(*finding.expected, actual, options);
    finding.comparable = comparison.comparable;
    if (!comparison.same) finding.difference = comparison.reason;
    return finding;
}

// Writes what shows the difference; what belongs to another difference is removed.
void show(const Finding& finding, const Image& actual, const Places& places, const CompareOptions& options) {
    fs::create_directories(places.actual.parent_path());
    fs::remove(places.expected);
    fs::remove(places.heat_map);
    if (finding.expected) write_file(places.expected, bytes_of(places.golden));
    write_image(actual, places.actual);
    if (finding.comparable) write_image(heat_map(*finding.expected, actual, options), places.heat_map);
}

std::string failure_message(const Finding& finding, const Places& places) {
    std::string message = places.golden.string() + ": " + finding.difference;
    if (finding.expected) message += "\n  expected  " + places.expected.string();
    message += "\n  actual    " + places.actual.string();
    if (finding.comparable) message += "\n  heat map  " + places.heat_map.string();
    return message + "\nIf the actual picture is right, " +
           (finding.expected ? "accept it" : "make it the golden picture") +
           ": run the test again with UPDATE_GOLDENS=1 in the environment";
}

// The golden picture is replaced only by what gives the picture back. \throw InvalidInput  the format does not.
GoldenResult accept(const Image& actual, const Places& places, const CompareOptions& options) {
    output_format(places.golden);  // complains before any work
    fs::create_directories(places.actual.parent_path());
    write_image(actual, places.actual, {.compression = smallest_files});
    const std::string difference = look_at(actual, places.actual, options).difference;
    if (!difference.empty()) {
        throw InvalidInput(places.golden.string(), "a file of this kind does not keep the picture: " + difference,
                           "use .png, .tif or .exr");
    }
    fs::create_directories(places.golden.parent_path());
    write_file(places.golden, bytes_of(places.actual));
    for (const fs::path& shown : {places.expected, places.actual, places.heat_map}) fs::remove(shown);
    return {true, true, "wrote the golden picture " + places.golden.string()};
}

GoldenResult fail(const std::string& message) {
    return {false, false, message};
}

}  // namespace

GoldenResult check_golden(const Image& actual, const fs::path& golden, const GoldenOptions& options,
                          const fs::path& usual_folder) {
    try {
        if (const std::string fault = fault_of(actual.pixels); !fault.empty())
            return fail(golden.string() + ": " + fault);
        const Places places = places_of(golden, options, usual_folder);
        const Finding finding = look_at(actual, places.golden, options.compare);
        if (finding.difference.empty()) return {true, false, {}};
        if (environment("UPDATE_GOLDENS") == "1") return accept(actual, places, options.compare);
        show(finding, actual, places, options.compare);
        return fail(failure_message(finding, places));
    } catch (const Error& error) {
        return fail(error.what());
    } catch (const fs::filesystem_error& error) {
        return fail(golden.string() + ": " + error.what());
    }
}

}  // namespace puppetwarp
