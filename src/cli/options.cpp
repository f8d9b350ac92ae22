#include "options.h"

#include "option_table.h"

#include <puppetwarp/base/errors.h>
#include <puppetwarp/base/input_file.h>
#include <puppetwarp/base/output_file.h>
#include <puppetwarp/mesh/automatic_cage.h>
#include <puppetwarp/project/weights_cache.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <numbers>

namespace puppetwarp::cli {

namespace fs = std::filesystem;

namespace {

[[noreturn]] void fail_pin(const std::string& text) {
    throw InvalidInput("--pin " + text, "is not a pin",
                       "write X,Y to hold a place, X,Y:X2,Y2 to move it, @DEG to turn it");
}

// A finite number, or nothing.
std::optional<double> number_from(std::string_view text) {
    if (!text.empty() && text.front() == '+') text.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
    return value;
}

// Standard output by any of its names.
bool is_standard_output(const fs::path& path) {
    return path == "-" || path == "/dev/stdout" || path == "/dev/fd/1" || path == "/proc/self/fd/1";
}

// One regular file by two names, there or not yet.
bool same_place(const fs::path& a, const fs::path& b) {
    if (is_standard_output(a) || is_standard_output(b)) return false;
    std::error_code error;
    if (fs::exists(a, error) && fs::exists(b, error))
        return fs::is_regular_file(a, error) && fs::equivalent(a, b, error);
    return fs::weakly_canonical(fs::absolute(a), error) == fs::weakly_canonical(fs::absolute(b), error);
}

Point parse_pin_point(std::string_view text, const std::string& pin) {
    const std::size_t comma = text.find(',');
    if (comma == std::string_view::npos) fail_pin(pin);
    const auto x = number_from(text.substr(0, comma));
    const auto y = number_from(text.substr(comma + 1));
    if (!x || !y) {
        throw InvalidInput("--pin " + pin, "'" + std::string(text) + "' is not a pair of finite numbers", "write X,Y");
    }
    return {*x, *y};
}

}  // namespace

double parse_number(const std::string& text, const std::string& option) {
    if (const auto value = number_from(text)) return *value;
    throw InvalidInput(option, "'" + text + "' is not a finite number");
}

Pin parse_pin(const std::string& text) {
    Pin pin;
    std::string_view rest = text;
    if (const std::size_t at = rest.find('@'); at != std::string_view::npos) {
        const auto degrees = number_from(rest.substr(at + 1));
        if (!degrees) fail_pin(text);
        pin.rotate_rad = *degrees * std::numbers::pi / 180;
        rest = rest.substr(0, at);
    }
    if (const std::size_t colon = rest.find(':'); colon != std::string_view::npos) {
        pin.to = parse_pin_point(rest.substr(colon + 1), text);
        rest = rest.substr(0, colon);
    }
    pin.at = parse_pin_point(rest, text);
    return pin;
}

CanvasChoice parse_canvas(const std::string& text) {
    if (text == "keep") return {CanvasChoice::Kind::keep, {}};
    if (text == "grow") return {CanvasChoice::Kind::grow, {}};
    Canvas canvas;
    const char* const end = text.data() + text.size();
    const auto integer = [&](const char* from, int& value) {
        if (from < end && *from == '+') ++from;
        const auto [next, error] = std::from_chars(from, end, value);
        return error == std::errc() ? next : nullptr;
    };
    const char* next = integer(text.data(), canvas.width);
    next = next && next < end && *next == 'x' ? integer(next + 1, canvas.height) : nullptr;
    if (next && next < end) {
        next = *next == '+' || *next == '-' ? integer(next, canvas.x) : nullptr;
        next = next && next < end && (*next == '+' || *next == '-') ? integer(next, canvas.y) : nullptr;
    }
    if (next != end || canvas.width < 1 || canvas.height < 1) {
        throw InvalidInput("--canvas " + text, "is not a canvas", "write keep, grow, or WxH+X+Y in whole pixels");
    }
    return {CanvasChoice::Kind::given, canvas};
}

double parse_share(const std::string& text, const std::string& option) {
    const std::size_t slash = text.find('/');
    double value = parse_number(text.substr(0, slash), option);
    if (slash != std::string::npos) {
        const double whole = parse_number(text.substr(slash + 1), option);
        if (whole <= 0) throw InvalidInput(option + ' ' + text, "divides by a number that is not above 0");
        value /= whole;
    }
    if (!(value >= 0 && value <= 1)) {
        throw InvalidInput(option + ' ' + text, "is not between 0 and 1", "write it as 0.02 or as 4/255");
    }
    return value;
}

CLI::Validator above_zero() {
    return {[](std::string& text) {
                const auto value = number_from(text);
                return value && *value > 0 ? std::string() : "'" + text + "' is not a number above 0";
            },
            ""};
}

CLI::Validator not_negative() {
    return {[](std::string& text) {
                const auto value = number_from(text);
                return value && *value >= 0 ? std::string() : "'" + text + "' is not a number of at least 0";
            },
            ""};
}

CLI::Validator not_empty() {
    return {[](std::string& text) { return text.empty() ? std::string("it must not be empty") : std::string(); }, ""};
}

void WeightChoice::add_to(CLI::App& subcommand, const std::string& option) {
    std::string kinds;
    for (const std::string& name : weight_kind_names()) kinds += (kinds.empty() ? "" : ", ") + name;
    const bool beside_method = option == "--weights";
    subcommand
        .add_option(option, kind,
                    (beside_method ? "Of fast, lbs, dual-complex and intrinsic: " : "") + kinds +
                        " (default: the puppet file's, else bbw)")
        ->type_name("KIND")
        ->check(completed_by(weight_kind_names()));
    subcommand
        .add_option("--partition", partition,
                    "Of bbw: coupled (default), weights sum to 1 in the minimisation, or normalised, afterwards")
        ->type_name("P")
        ->check(completed_by({partition_name(Partition::coupled), partition_name(Partition::normalised)}));
    subcommand
        .add_option("--l1-budget", l1_budget,
                    "Of l1: largest integral of a weight, as a share of what it has without (0 to 1, default 0.8)")
        ->type_name("S")
        ->check(above_zero());
    subcommand.add_flag("--no-cache", no_cache,
                        "Neither use nor write NAME.puppet.weights, which keeps bbw, l1 and monotonic weights beside "
                        "the puppet file");
}

fs::path WeightChoice::cache_beside(const fs::path& input) const {
    return no_cache || !is_puppet_file(input) ? fs::path() : weights_cache_path(input);
}

WeightOptions WeightChoice::options(WeightOptions usual) const {
    if (kind) usual.kind = weight_kind_from_name(*kind);
    if (partition) usual.partition = partition_from_name(*partition);
    if (l1_budget) usual.l1_budget = *l1_budget;
    return usual;
}

void HandleChoice::add_to(CLI::App& subcommand) {
    subcommand
        .add_option("--auto-cage", automatic_cage,
                    "Put a cage of N corners around the subject, a handle 'cage' beside the others")
        ->type_name("N")
        ->check(CLI::Range(fewest_cage_corners, most_cage_corners));
    subcommand
        .add_option("--save-puppet", save_puppet,
                    "Also write a puppet file with the handles of this run, to make poses of them")
        ->type_name("PUPPET");
}

void HandleChoice::save(Puppet puppet, const Rig& rig) const {
    if (save_puppet.empty()) return;
    if (automatic_cage > 0) puppet.rig.handles.push_back(rig.handles.back());
    write_puppet(puppet, save_puppet);
}

std::vector<std::string> arap_energy_names() {
    std::vector<std::string> names;
    for (const ArapEnergy energy : {ArapEnergy::elements, ArapEnergy::spokes, ArapEnergy::spokes_and_rims}) {
        names.push_back(arap_energy_name(energy));
    }
    return names;
}

std::string method_list() {
    std::string list;
    for (const std::string& name : method_names()) list += (list.empty() ? "" : ", ") + name;
    return list;
}

void add_pins(Puppet& puppet, Pose& pose, const std::vector<std::string>& pins) {
    if (!pins.empty() && pose.name == "rest") pose.name = "pins";
    int number = 0;
    for (const std::string& text : pins) {
        const Pin pin = parse_pin(text);
        std::string id;
        do {
            id = "pin" + std::to_string(++number);
        } while (find_handle(puppet.rig, id));
        puppet.rig.handles.push_back({id, PointHandle{pin.at, std::nullopt}});
        if (pin.to || pin.rotate_rad) {
            HandlePose& target = pose.handles[id];
            target.to = pin.to;
            target.rotate_rad = pin.rotate_rad;
        }
    }
}

std::string lower_extension(const fs::path& path) {
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return std::tolower(c); });
    return extension;
}

bool is_puppet_file(const fs::path& path) {
    return lower_extension(path) == ".json";
}

bool is_mesh_file(const fs::path& path) {
    const std::string extension = lower_extension(path);
    return extension == ".off" || extension == ".obj";
}

Puppet open_puppet(const fs::path& path) {
    if (is_puppet_file(path)) return read_puppet(path);
    require_readable_file(path);
    Puppet puppet;
    puppet.folder = path.parent_path();
    puppet.image = path.filename().string();
    return puppet;
}

std::vector<fs::path> input_files(const fs::path& path, const Puppet& puppet) {
    std::vector<fs::path> files{path};
    for (const std::string& name : {puppet.image, puppet.cutout.path}) {
        if (!name.empty()) files.push_back(resolve(puppet, name));
    }
    for (const Stiffness& stiffness : puppet.rig.stiffness) {
        if (const auto* picture = std::get_if<StiffnessPicture>(&stiffness))
            files.push_back(resolve(puppet, picture->path));
    }
    return files;
}

void require_good_outputs(const Files& files, std::optional<bool> force) {
    std::vector<fs::path> seen;
    bool stdout_taken = files.json_to_stdout;
    for (const fs::path& output : files.outputs) {
        if (output.empty()) continue;
        if (is_standard_output(output)) {
            if (stdout_taken) throw InvalidInput("usage", "two results want standard output", "send one to a file");
            stdout_taken = true;
        }
        for (const fs::path& other : seen) {
            if (same_place(output, other)) throw InvalidInput(output.string(), "is named for two results");
        }
        for (const fs::path& input : files.inputs) {
            if (force.value_or(false) || input.empty() || !same_place(output, input)) continue;
            throw InvalidInput(output.string(), "is the input itself",
                               force ? "choose another name, or --force to replace it" : "choose another name");
        }
        // A pipe's reader would take this opening and closing for the end of the data.
        if (!OutputFile::is_stream(output)) OutputFile probe(output);
        seen.push_back(output);
    }
}

}  // namespace puppetwarp::cli
