// The macros as a test of somebody else's uses them.

#include "support/environment.h"
#include "support/run_command.h"

#include <gtest/gtest-spi.h>
#include <gtest/gtest.h>
#include <puppetwarp/image/write.h>
#include <puppetwarp/testing/image_test.h>
#include <opencv2/core.hpp>

namespace {

using puppetwarp::GoldenOptions;
using puppetwarp::Image;
using puppetwarp::tests::EnvironmentVariable;
using puppetwarp::tests::TemporaryFolder;

Image grey(int level) {
    Image image;
    image.pixels = cv::Mat(8, 8, CV_8UC1, cv::Scalar(level));
    return image;
}

class ImageTest : public testing::Test {
protected:
    ImageTest() { puppetwarp::write_image(grey(100), folder / "grey.png"); }

    TemporaryFolder folder;
    EnvironmentVariable goldens{"PUPPETWARP_GOLDEN_FOLDER", folder.path().string()};
    EnvironmentVariable output{"PUPPETWARP_IMAGE_TEST_OUTPUT", folder / "failures"};
    EnvironmentVariable update{"UPDATE_GOLDENS", std::nullopt};
};

TEST_F(ImageTest, PassesWithAndWithoutOptions) {
    EXPECT_IMAGE_NEAR(grey(100), "grey.png");
    ASSERT_IMAGE_NEAR(grey(100), "grey.png") << "a word of the test's own";
    EXPECT_IMAGE_NEAR(grey(102), "grey.png", {.compare = {.threshold = 2 / 255.0}});
    const GoldenOptions options{.compare = {.threshold = 0.5}, .golden_folder = folder.path()};
    EXPECT_IMAGE_NEAR(grey(200), "grey.png", options);
}

TEST_F(ImageTest, FailsWithWhatDiffers) {
    const std::string reason = puppetwarp::compare(grey(100), grey(103)).reason;
    EXPECT_NONFATAL_FAILURE(EXPECT_IMAGE_NEAR(grey(103), "grey.png"), reason);
    EXPECT_NONFATAL_FAILURE(EXPECT_IMAGE_NEAR(grey(103), "grey.png"), "grey.heatmap.png");
    EXPECT_NONFATAL_FAILURE(EXPECT_IMAGE_NEAR(grey(103), "grey.png") << "a word of the test's own",
                            "a word of the test's own");
    EXPECT_NONFATAL_FAILURE(EXPECT_IMAGE_NEAR(grey(100), "none.png"), "there is no golden picture yet");
    EXPECT_FATAL_FAILURE(ASSERT_IMAGE_NEAR(grey(103), "grey.png"), "grey.heatmap.png");
}

TEST_F(ImageTest, SaysWhatItAccepts) {
    const EnvironmentVariable updating("UPDATE_GOLDENS", "1");
    testing::internal::CaptureStdout();
    EXPECT_IMAGE_NEAR(grey(103), "grey.png");
    EXPECT_EQ(testing::internal::GetCapturedStdout(),
              "[ GOLDEN   ] wrote the golden picture " + (folder / "grey.png") + "\n");
    EXPECT_NONFATAL_FAILURE(EXPECT_IMAGE_NEAR(Image(), "grey.png"), "empty");
}

}  // namespace
