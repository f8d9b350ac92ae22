#include <gtest/gtest.h>

#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <ostream>
#include <string>
#include <vector>

#include "support/run_command.h"

namespace puppetwarp::tests {
namespace {

namespace fs = std::filesystem;

struct GoldenPose {
    std::string sample;
    std::string pose;
    std::string canvas = "keep";  // a part of large pictures is enough

    std::string name() const { return sample + "." + pose; }
};

void PrintTo(const GoldenPose& golden, std::ostream* out) {
    *out << golden.name();
}

class Golden : public ::testing::TestWithParam<GoldenPose> {};

// Warps through the command, compares through the command. Two levels of tolerance: processors may differ by one, and
// the minimum of an energy is found only so exactly.
TEST_P(Golden, PoseLooksAsItDidWhenAPersonLookedAtIt) {
    const GoldenPose& golden = GetParam();
    const fs::path source = PUPPETWARP_SOURCE_DIR, folder = fs::path(PUPPETWARP_BINARY_DIR) / "golden";
    fs::create_directories(folder);
    const fs::path expected = source / "tests" / "golden" / (golden.name() + ".golden.png");
    const fs::path actual = folder / (golden.name() + ".actual.png");
    const fs::path heat_map = folder / (golden.name() + ".heatmap.png");
    fs::remove(heat_map);

    const char* update = std::getenv("PUPPETWARP_UPDATE_GOLDENS");
    const bool updating = update && std::string(update) == "1";
    const CommandResult warped = puppetwarp_command(
        {"warp", source / "images" / (golden.sample + ".puppet.json"), "--pose", golden.pose, "--canvas", golden.canvas,
         "--compression", updating ? "9" : "1", "--no-cache", "--fail-on-fold", "-o", actual});
    ASSERT_EQ(warped.exit_code, 0) << warped.errors;
    if (updating) {
        fs::copy_file(actual, expected, fs::copy_options::overwrite_existing);
        return;
    }
    const CommandResult compared =
        puppetwarp_command({"diff", expected, actual, "--threshold", "2/255", "--heatmap", heat_map});
    EXPECT_EQ(compared.exit_code, 0) << compared.output << compared.errors << "expected " << expected << "\nactual   "
                                     << actual << "\nwhere    " << heat_map
                                     << "\nIf it is better so: ./dev test --update-goldens";
    if (compared.exit_code == 0) fs::remove(heat_map);
}

const std::vector<GoldenPose> kPoses{
    {"gingerbread", "wave"},
    {"figure", "walk"},
    {"ring", "lean"},
    {"tail", "swish"},
    {"photo", "proud", "500x640+320+130"},
    {"jellyfish", "drift", "560x420+80+30"},
    {"figure.bones", "left-contact", "520x560+220+620"},
    {"figure.bones", "left-passing", "520x560+220+620"},
    {"tail.bones", "curious", "380x420+790+110"},
    {"ring.cage", "heart", "440x440+280+460"},
};

INSTANTIATE_TEST_SUITE_P(All, Golden, ::testing::ValuesIn(kPoses), [](const auto& tested) {
    std::string name = tested.param.name();
    for (char& c : name) {
        if (std::isalnum(static_cast<unsigned char>(c)) == 0) c = '_';
    }
    return name;
});

}  // namespace
}  // namespace puppetwarp::tests
