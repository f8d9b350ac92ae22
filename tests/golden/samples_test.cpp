#include "samples.h"

#include <gtest/gtest.h>
#include <puppetwarp/diff/compare.h>
#include <puppetwarp/image/read.h>
#include <puppetwarp/image/write.h>

#include <filesystem>
#include <ostream>

namespace samples {

void PrintTo(const Sample& sample, std::ostream* out) {
    *out << sample.name;
}

namespace {

class CommittedSample : public ::testing::TestWithParam<Sample> {};

// Within one level of 8 bits: another processor's mathematics library may round the last bit otherwise.
TEST_P(CommittedSample, IsWhatTheProgramDraws) {
    const auto& [name, draw] = GetParam();
    const std::filesystem::path committed = std::filesystem::path(PUPPETWARP_SOURCE_DIR) / "images" / (name + ".png");
    const puppetwarp::Image expected = puppetwarp::read_image(committed), actual = draw();
    const puppetwarp::Comparison comparison = puppetwarp::compare(expected, actual, {.threshold = 1 / 255.0});
    EXPECT_EQ(expected.pixels.depth(), actual.pixels.depth());
    if (comparison.same) return;

    const std::filesystem::path folder = std::filesystem::path(PUPPETWARP_BINARY_DIR) / "golden";
    std::filesystem::create_directories(folder);
    puppetwarp::write_image(actual, folder / (name + ".actual.png"));
    if (comparison.comparable) {
        puppetwarp::write_image(puppetwarp::heat_map(expected, actual), folder / (name + ".heatmap.png"));
    }
    ADD_FAILURE() << committed << " is not what draw_samples draws: " << comparison.reason << "; see "
                  << folder / (name + ".actual.png") << " and " << name << ".heatmap.png";
}

INSTANTIATE_TEST_SUITE_P(All, CommittedSample, ::testing::ValuesIn(all_samples()),
                         [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace samples
