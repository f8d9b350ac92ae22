#include "support/environment.h"
#include "support/run_command.h"

#include <puppetwarp/image/read.h>
#include <puppetwarp/image/write.h>
#include <puppetwarp/testing/golden.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

namespace puppetwarp {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;
using tests::bytes_of;
using tests::EnvironmentVariable;
using tests::put_bytes;

// A gradient that no two pixels of which are equal.
Image gradient(int width = 24, int height = 16) {
    Image image;
    image.pixels = cv::Mat(height, width, CV_8UC3);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            image.pixels.at<cv::Vec3b>(y, x) =
                cv::Vec3b(static_cast<unsigned char>(10 * x), static_cast<unsigned char>(15 * y), 128);
        }
    }
    return image;
}

// One channel of one pixel is `levels` brighter.
Image brightened(int levels) {
    Image image = gradient();
    auto& pixel = image.pixels.at<cv::Vec3b>(5, 3);
    pixel[2] = static_cast<unsigned char>(pixel[2] + levels);
    return image;
}

bool same_pixels(const cv::Mat& a, const cv::Mat& b) {
    return a.size() == b.size() && a.type() == b.type() && cv::norm(a, b, cv::NORM_INF) == 0;
}

class Golden : public testing::Test {
protected:
    Golden() { write_image(gradient(), goldens / "star.png"); }

    GoldenResult check(const Image& actual, const std::string& golden = "star.png", double threshold = 0) const {
        return check_golden(actual, golden, {{.threshold = threshold}, goldens.path(), output});
    }
    bool shows(const std::string& name) const { return fs::exists(output / name); }

    tests::TemporaryFolder goldens;
    tests::TemporaryFolder outside;
    fs::path output = outside.path() / "failures";
    EnvironmentVariable update{"UPDATE_GOLDENS", std::nullopt};
    EnvironmentVariable golden_folder{"PUPPETWARP_GOLDEN_FOLDER", std::nullopt};
    EnvironmentVariable output_folder{"PUPPETWARP_IMAGE_TEST_OUTPUT", std::nullopt};
};

TEST_F(Golden, TheSamePicturePassesAndLeavesNothing) {
    const GoldenResult result = check(gradient());
    EXPECT_TRUE(result.passed) << result.message;
    EXPECT_FALSE(result.updated);
    EXPECT_EQ(result.message, "");
    EXPECT_FALSE(fs::exists(output));
}

TEST_F(Golden, AnotherPictureFailsAndLeavesThreePictures) {
    const Image actual = brightened(40);
    const GoldenResult result = check(actual);
    EXPECT_FALSE(result.passed);
    EXPECT_EQ(bytes_of(output / "star.expected.png"), bytes_of(goldens / "star.png"));
    EXPECT_TRUE(same_pixels(read_image(output / "star.actual.png").pixels, actual.pixels));
    EXPECT_TRUE(same_pixels(read_image(output / "star.heatmap.png").pixels, heat_map(gradient(), actual).pixels));

    const std::string reason = compare(gradient(), actual).reason;
    EXPECT_THAT(result.message, HasSubstr((goldens / "star.png") + ": " + reason + "\n"));
    for (const char* file : {"star.expected.png", "star.actual.png", "star.heatmap.png"}) {
        EXPECT_THAT(result.message, HasSubstr((output / file).string()));
    }
    EXPECT_THAT(result.message, HasSubstr("UPDATE_GOLDENS=1"));
}

TEST_F(Golden, OptionsDecideWhatIsNear) {
    EXPECT_FALSE(check(brightened(3), "star.png", 2.0 / 255).passed);
    EXPECT_TRUE(check(brightened(2), "star.png", 2.0 / 255).passed);
    EXPECT_THAT(check(gradient(), "star.png", 7).message, HasSubstr("threshold 7"));  // options are checked too
}

TEST_F(Golden, AnotherSizeHasNoHeatMap) {
    check(brightened(40));
    ASSERT_TRUE(shows("star.heatmap.png"));
    const GoldenResult result = check(gradient(20, 10));
    EXPECT_FALSE(result.passed);
    EXPECT_THAT(result.message, HasSubstr(compare(gradient(), gradient(20, 10)).reason));
    EXPECT_THAT(result.message, Not(HasSubstr("heat map")));
    EXPECT_TRUE(shows("star.expected.png"));
    EXPECT_TRUE(shows("star.actual.png"));
    EXPECT_FALSE(shows("star.heatmap.png"));  // the old one would mislead
}

TEST_F(Golden, AMissingGoldenFailsAndSaysHowToMakeIt) {
    const GoldenResult result = check(gradient(), "moon.png");
    EXPECT_FALSE(result.passed);
    EXPECT_THAT(result.message, HasSubstr("there is no golden picture yet"));
    EXPECT_THAT(result.message, HasSubstr("UPDATE_GOLDENS=1"));
    EXPECT_TRUE(same_pixels(read_image(output / "moon.actual.png").pixels, gradient().pixels));
    EXPECT_FALSE(fs::exists(goldens / "moon.png"));
    EXPECT_FALSE(shows("moon.expected.png"));
}

TEST_F(Golden, AGoldenThatIsNoPictureFails) {
    put_bytes(goldens / "star.png", "this is no picture");
    const GoldenResult result = check(gradient());
    EXPECT_FALSE(result.passed);
    EXPECT_THAT(result.message, HasSubstr("the golden picture cannot be read"));
    EXPECT_TRUE(shows("star.actual.png"));
    const EnvironmentVariable updating("UPDATE_GOLDENS", "1");
    EXPECT_TRUE(check(gradient()).updated);
    EXPECT_TRUE(same_pixels(read_image(goldens / "star.png").pixels, gradient().pixels));
}

TEST_F(Golden, UpdatingAcceptsWhatWouldFail) {
    Image deep = gradient();
    deep.pixels.convertTo(deep.pixels, CV_16U, 250);  // no 8-bit picture has these values
    for (const char* name : {"star.png", "new/moon.png", "sun.tif", "planet.exr"}) {
        {
            const EnvironmentVariable updating("UPDATE_GOLDENS", "1");
            const GoldenResult result = check(deep, name);
            EXPECT_TRUE(result.passed && result.updated) << result.message;
            EXPECT_THAT(result.message, HasSubstr("wrote the golden picture " + (goldens / name)));
            EXPECT_FALSE(check(deep, name).updated);  // it passes now
        }
        const GoldenResult again = check(deep, name);
        EXPECT_TRUE(again.passed) << again.message;
    }
    for (const auto& left : fs::recursive_directory_iterator(output)) EXPECT_TRUE(left.is_directory()) << left.path();
}

TEST_F(Golden, UpdatingRemovesThePicturesOfWhatItAccepts) {
    EXPECT_FALSE(check(brightened(40)).passed);
    EXPECT_TRUE(shows("star.heatmap.png"));
    const EnvironmentVariable updating("UPDATE_GOLDENS", "1");
    EXPECT_TRUE(check(brightened(40)).updated);
    for (const char* file : {"star.expected.png", "star.actual.png", "star.heatmap.png"}) EXPECT_FALSE(shows(file));
}

TEST_F(Golden, UpdatingLeavesWhatPasses) {
    const std::string before = bytes_of(goldens / "star.png");
    const EnvironmentVariable updating("UPDATE_GOLDENS", "1");
    const GoldenResult result = check(brightened(2), "star.png", 2.0 / 255);
    EXPECT_TRUE(result.passed);
    EXPECT_FALSE(result.updated);
    EXPECT_EQ(bytes_of(goldens / "star.png"), before);
}

TEST_F(Golden, OnlyTheOneValueUpdates) {
    for (const char* value : {"", "0", "true", "11"}) {
        const EnvironmentVariable updating("UPDATE_GOLDENS", value);
        EXPECT_FALSE(check(brightened(40)).passed) << value;
    }
}

TEST_F(Golden, AFormatThatLosesIsRefusedBeforeItReplacesAnything) {
    const EnvironmentVariable updating("UPDATE_GOLDENS", "1");
    const GoldenResult lossy = check(gradient(), "star.jpg");
    EXPECT_FALSE(lossy.passed);
    EXPECT_THAT(lossy.message, HasSubstr("does not keep the picture"));
    EXPECT_FALSE(fs::exists(goldens / "star.jpg"));
    EXPECT_THAT(check(gradient(), "star.bmp").message, HasSubstr("unknown picture extension"));
    EXPECT_THAT(check(gradient(), "star").message, HasSubstr("no extension"));
}

TEST_F(Golden, PicturesThatAreNone) {
    EXPECT_THAT(check(Image()).message, HasSubstr("the actual picture is empty"));
    Image doubles;
    doubles.pixels = cv::Mat(16, 24, CV_64FC3, cv::Scalar::all(0));
    EXPECT_THAT(check(doubles).message, HasSubstr("neither 8-bit, 16-bit nor float"));
    const EnvironmentVariable updating("UPDATE_GOLDENS", "1");
    EXPECT_FALSE(check(Image()).passed);
    EXPECT_FALSE(check(doubles).passed);
}

TEST_F(Golden, AFolderThatCannotBeWrittenIsAFailureToo) {
    put_bytes(outside / "file", "in the way");
    output = outside.path() / "file" / "failures";
    const GoldenResult result = check(brightened(40));
    EXPECT_FALSE(result.passed);
    EXPECT_THAT(result.message, HasSubstr("failures"));
}

TEST_F(Golden, FailuresStayInTheirFolderWhereverTheGoldenIs) {
    const auto failing = [&](const fs::path& golden) {
        return check_golden(brightened(40), golden, {{}, goldens.path(), output}).passed;
    };
    EXPECT_FALSE(failing("a/b/moon.png"));
    EXPECT_TRUE(shows("a/b/moon.actual.png"));
    EXPECT_FALSE(failing("../sun.png"));
    EXPECT_TRUE(shows("sun.actual.png"));
    EXPECT_FALSE(failing(goldens.path() / "star.png"));
    EXPECT_TRUE(shows("star.heatmap.png"));
}

TEST_F(Golden, FoldersComeFromOptionsThenEnvironmentThenTheProgram) {
    const tests::TemporaryFolder other;
    write_image(brightened(40), other / "star.png");
    EXPECT_TRUE(check_golden(gradient(), "star.png", {}, goldens.path()).passed);
    const EnvironmentVariable named("PUPPETWARP_GOLDEN_FOLDER", other.path().string());
    const EnvironmentVariable written("PUPPETWARP_IMAGE_TEST_OUTPUT", (other.path() / "out").string());
    EXPECT_FALSE(check_golden(gradient(), "star.png", {}, goldens.path()).passed);
    EXPECT_TRUE(fs::exists(other.path() / "out/star.heatmap.png"));
    EXPECT_TRUE(check_golden(gradient(), "star.png", {{}, goldens.path(), {}}).passed);
    EXPECT_FALSE(check(brightened(40)).passed);
    EXPECT_TRUE(shows("star.heatmap.png"));
}

TEST_F(Golden, WithoutAWordFailuresGoToTheWorkingFolder) {
    const fs::path before = fs::current_path();
    fs::current_path(outside.path());
    const GoldenResult result = check_golden(brightened(40), goldens.path() / "star.png");
    fs::current_path(before);
    EXPECT_FALSE(result.passed);
    EXPECT_TRUE(fs::exists(outside.path() / "image-tests/star.actual.png"));
    EXPECT_THAT(result.message, HasSubstr((outside.path() / "image-tests/star.actual.png").string()));
}

}  // namespace
}  // namespace puppetwarp
