#include <puppetwarp/image/read.h>
#include <puppetwarp/image/write.h>

#include "test_pictures.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace puppetwarp {
namespace {

using test::noise;
using test::refusal;
using test::TemporaryFolder;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(OutputFormat, FollowsTheExtensionInAnyCase) {
    EXPECT_EQ(output_format("a.png"), "png");
    EXPECT_EQ(output_format("some.where/a.PNG"), "png");
    EXPECT_EQ(output_format("a.jpg"), "jpeg");
    EXPECT_EQ(output_format("a.JPeG"), "jpeg");
    EXPECT_EQ(output_format("a.tif"), "tiff");
    EXPECT_EQ(output_format("a.tiff"), "tiff");
    EXPECT_EQ(output_format("a.b.webp"), "webp");
    EXPECT_EQ(output_format("a.exr"), "exr");
    EXPECT_EQ(output_format("a.pgm"), "pgm");
}

TEST(OutputFormat, StreamsArePng) {
    EXPECT_EQ(output_format("-"), "png");
    EXPECT_EQ(output_format("/dev/stdout"), "png");
    EXPECT_EQ(output_format("/dev/fd/1"), "png");
    EXPECT_EQ(output_format("/dev/null"), "png");
}

TEST(OutputFormat, UnknownExtensionNamesTheKnownOnes) {
    EXPECT_THAT(refusal([] { output_format("a.docx"); }),
                AllOf(HasSubstr("'.docx'"), HasSubstr(".png"), HasSubstr(".exr")));
    EXPECT_THAT(refusal([] { output_format("png"); }), HasSubstr("no extension"));
    EXPECT_THAT(refusal([] { output_format("a."); }), HasSubstr(".png"));
    EXPECT_THAT(refusal([] { write_image({noise(1, 1, CV_8U, 1, 1), {}}, "a.gif"); }), HasSubstr("'.gif'"));
}

Image with_everything(int depth, int channels) {
    Image image{noise(8, 8, depth, channels, 1), {}};
    image.metadata.icc = test::icc_profile("srgb");
    image.metadata.exif = test::exif_block(1);
    image.metadata.xmp = {'<', 'x', '/', '>'};
    image.metadata.x_pixels_per_mm = image.metadata.y_pixels_per_mm = 4;
    return image;
}

TEST(LostInFormat, NamesWhatEachFormatCannotHold) {
    EXPECT_THAT(lost_in_format(with_everything(CV_16U, 4), "png"), IsEmpty());
    EXPECT_THAT(lost_in_format(with_everything(CV_32F, 3), "png"), ElementsAre("floating-point values"));
    EXPECT_THAT(lost_in_format(with_everything(CV_16U, 4), "jpeg"), ElementsAre("alpha", "16 bits a channel"));
    EXPECT_THAT(lost_in_format(with_everything(CV_8U, 3), "jpeg"), IsEmpty());
    EXPECT_THAT(lost_in_format(with_everything(CV_32F, 4), "tiff"), ElementsAre("EXIF"));
    EXPECT_THAT(lost_in_format(with_everything(CV_16U, 4), "webp"), ElementsAre("16 bits a channel", "resolution"));
    EXPECT_THAT(lost_in_format(with_everything(CV_16U, 4), "exr"), ElementsAre("ICC profile", "EXIF", "XMP"));
    EXPECT_THAT(lost_in_format(with_everything(CV_8U, 4), "pgm"),
                ElementsAre("colour", "alpha", "ICC profile", "EXIF", "XMP", "resolution"));
    EXPECT_THAT(lost_in_format(with_everything(CV_16U, 3), "ppm"),
                ElementsAre("ICC profile", "EXIF", "XMP", "resolution"));
    EXPECT_THAT(lost_in_format(with_everything(CV_16U, 3), "pfm"),
                ElementsAre("ICC profile", "EXIF", "XMP", "resolution"));
    EXPECT_THAT(refusal([] { lost_in_format(with_everything(CV_8U, 3), "gif"); }), HasSubstr("gif"));
}

TEST(LostInFormat, AlphaThatIsFullEverywhereIsNoLoss) {
    for (const int depth : {CV_8U, CV_16U, CV_32F}) {
        Image image{cv::Mat(4, 4, CV_MAKETYPE(depth, 4)), {}};
        image.pixels.setTo(cv::Scalar::all(image.full_value()));
        EXPECT_THAT(lost_in_format(image, "ppm"), testing::Not(testing::Contains("alpha")));
    }
}

TEST(LostInFormat, AProfileOfOtherChannelsIsLost) {
    Image image{noise(4, 4, CV_8U, 1, 1), {}};
    image.metadata.icc = test::icc_profile("srgb");
    EXPECT_THAT(lost_in_format(image, "png"), ElementsAre("ICC profile"));
    image.metadata.icc = test::grey_profile();
    EXPECT_THAT(lost_in_format(image, "png"), IsEmpty());
    EXPECT_THAT(lost_in_format(image, "webp"), ElementsAre("ICC profile"));  // WebP turns grey into RGB
}

TEST(LostInFormat, JpegSegmentsEndAt64KB) {
    Image image{noise(4, 4, CV_8U, 3, 1), {}};
    image.metadata.exif = test::exif_block(1);
    image.metadata.exif.resize(70000);
    image.metadata.xmp.assign(70000, 'x');
    EXPECT_THAT(lost_in_format(image, "jpeg"), ElementsAre("EXIF", "XMP"));
    EXPECT_THAT(lost_in_format(image, "png"), IsEmpty());
}

// What is promised to be kept must come back; what is promised to be lost must not.
TEST(LostInFormat, AgreesWithWhatComesBack) {
    const TemporaryFolder folder;
    for (const char* name : {"a.png", "a.jpg", "a.tif", "a.webp", "a.exr", "a.ppm", "a.pgm", "a.pnm", "a.pfm"}) {
        for (const int channels : {1, 2, 3, 4}) {
            for (const int depth : {CV_8U, CV_16U, CV_32F}) {
                Image image = with_everything(depth, channels);
                if (channels <= 2) image.metadata.icc = test::grey_profile();
                const auto lost = lost_in_format(image, output_format(folder / name));
                write_image(image, folder / name);
                const Image back = read_image(folder / name);
                const auto is_lost = [&](const char* what) { return std::count(lost.begin(), lost.end(), what) != 0; };
                SCOPED_TRACE(std::string(name) + " " + std::to_string(channels) + " depth " + std::to_string(depth));
                EXPECT_EQ(is_lost("ICC profile"), back.metadata.icc != image.metadata.icc);
                EXPECT_EQ(is_lost("EXIF"), back.metadata.exif != image.metadata.exif);
                EXPECT_EQ(is_lost("XMP"), back.metadata.xmp != image.metadata.xmp);
                EXPECT_EQ(is_lost("resolution"), std::abs(back.metadata.x_pixels_per_mm - 4) > 1e-6);
                EXPECT_EQ(is_lost("alpha"), !back.has_alpha() && image.has_alpha());
                EXPECT_EQ(is_lost("floating-point values"), depth == CV_32F && back.pixels.depth() != CV_32F);
                EXPECT_EQ(is_lost("16 bits a channel"), depth == CV_16U && back.pixels.depth() == CV_8U);
                EXPECT_EQ(is_lost("colour"), channels >= 3 && back.pixels.channels() < 3);
            }
        }
    }
}

}  // namespace
}  // namespace puppetwarp
