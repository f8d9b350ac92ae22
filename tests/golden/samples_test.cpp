#include "samples.h"

#include <puppetwarp/image/read.h>
#include <puppetwarp/testing/image_test.h>

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
    const puppetwarp::Image drawn = draw();
    ASSERT_IMAGE_NEAR(drawn, name + ".png", {.compare = {.threshold = 1 / 255.0}});
    const puppetwarp::ImageInfo committed = puppetwarp::read_image_info(PUPPETWARP_GOLDEN_FOLDER "/" + name + ".png");
    EXPECT_EQ(committed.bits, 8 * static_cast<int>(drawn.pixels.elemSize1()));
}

INSTANTIATE_TEST_SUITE_P(All, CommittedSample, ::testing::ValuesIn(all_samples()),
                         [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace samples
