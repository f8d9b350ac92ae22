#include <puppetwarp/diff/compare_files.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/base/stage_timer.h>

#include <puppetwarp/diff/verdict.h>

#include <future>
#include <string>
#include <utility>

namespace puppetwarp {

namespace fs = std::filesystem;

namespace {

struct ImagePair {
    Image expected;
    Image actual;
};

ImagePair read_in_turn(const fs::path& expected, const fs::path& actual, const ReadOptions& options) {
    Image first = read_image(expected, options);
    return {std::move(first), read_image(actual, options)};
}

// Reading takes far longer than comparing.
ImagePair read_at_once(const fs::path& expected, const fs::path& actual, const ReadOptions& options) {
    std::future<Image> reading = std::async(std::launch::async, [&] { return read_image(actual, options); });
    try {
        Image first = read_image(expected, options);
        return {std::move(first), reading.get()};
    } catch (const InvalidInput&) {
        if (reading.valid()) reading.wait();
    }
    // Decoders share one place for their complaints: alone, the file at fault gets its own.
    return read_in_turn(expected, actual, options);
}

void compare_orientations(const fs::path& expected, const fs::path& actual, const ReadOptions& options,
                          Comparison& comparison) {
    const int first = read_image_info(expected, options).orientation;
    const int second = read_image_info(actual, options).orientation;
    if (first == second) return;
    fail_metadata(
        "the orientation in the file differs: expected " + std::to_string(first) + ", actual " + std::to_string(second),
        comparison);
}

}  // namespace

ComparedFiles compare_files(const fs::path& expected, const fs::path& actual, const CompareOptions& options,
                            const ReadOptions& reading, bool show, PairReading order) {
    require_sound(options);
    ComparedFiles files;
    StageTimer timer(files.timings_ms);
    ImagePair pair = order == PairReading::at_once ? read_at_once(expected, actual, reading)
                                                   : read_in_turn(expected, actual, reading);
    timer.end("read");
    files.expected = std::move(pair.expected);
    files.actual = std::move(pair.actual);
    if (show) {
        ShownComparison shown = compare_and_show(files.expected, files.actual, options);
        files.comparison = std::move(shown.comparison);
        files.heat_map = std::move(shown.heat_map);
    } else {
        files.comparison = compare(files.expected, files.actual, options);
    }
    if (options.metadata) compare_orientations(expected, actual, reading, files.comparison);
    timer.end("compare");
    return files;
}

}  // namespace puppetwarp
