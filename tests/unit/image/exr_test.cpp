// EXR files that OpenEXR itself wrote for the test.
#include <puppetwarp/image/read.h>
#include <puppetwarp/image/write.h>

#include "test_pictures.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>

#include <half.h>

namespace puppetwarp {
namespace {

using test::refusal;
using test::TemporaryFolder;
using testing::HasSubstr;

// Channel values are 1, 2, 3, ... from the left in the first channel, 10 times that in the second, and so on.
void store_exr(const std::filesystem::path& path, const std::vector<std::string>& channels, Imf::PixelType type,
               const Imath::Box2i& window, int sampling = 1) {
    const int width = window.max.x - window.min.x + 1;
    const int height = window.max.y - window.min.y + 1;
    Imf::Header header(Imath::Box2i({0, 0}, {99, 99}), window);
    std::vector<std::vector<half>> halves(channels.size());
    std::vector<std::vector<float>> floats(channels.size());
    Imf::FrameBuffer frame;
    float factor = 1;
    for (std::size_t c = 0; c < channels.size(); ++c, factor *= 10) {
        header.channels().insert(channels[c], Imf::Channel(type, sampling, sampling));
        for (int i = 0; i < width * height; ++i) {
            halves[c].emplace_back(factor * static_cast<float>(i + 1));
            floats[c].push_back(factor * static_cast<float>(i + 1));
        }
        void* base = type == Imf::HALF ? static_cast<void*>(halves[c].data()) : floats[c].data();
        frame.insert(channels[c], Imf::Slice::Make(type, base, window, 0, 0, sampling, sampling));
    }
    Imf::OutputFile file(path.c_str(), header);
    file.setFrameBuffer(frame);
    file.writePixels(height);
}

TEST(Exr, HalvesAndFloatsBecomeFloatsInTheOrderOfRgb) {
    const TemporaryFolder folder;
    for (const Imf::PixelType type : {Imf::HALF, Imf::FLOAT}) {
        // The data window begins anywhere, left of the display window too.
        store_exr(folder / "a.exr", {"R", "G", "B"}, type, {{-3, 5}, {-2, 6}});
        const Image image = read_image(folder / "a.exr");
        ASSERT_EQ(image.pixels.type(), CV_32FC3);
        ASSERT_EQ(image.pixels.size(), cv::Size(2, 2));
        EXPECT_EQ(image.pixels.at<cv::Vec3f>(0, 0), cv::Vec3f(1, 10, 100));
        EXPECT_EQ(image.pixels.at<cv::Vec3f>(1, 1), cv::Vec3f(4, 40, 400));
        const ImageInfo info = read_image_info(folder / "a.exr");
        EXPECT_EQ(info.format, "exr");
        EXPECT_EQ(info.channels, 3);
        EXPECT_EQ(info.bits, 32);
    }
}

TEST(Exr, ColourIsDividedByAlpha) {
    const TemporaryFolder folder;
    store_exr(folder / "a.exr", {"A", "R", "G", "B"}, Imf::FLOAT, {{0, 0}, {1, 0}});
    const Image image = read_image(folder / "a.exr");
    ASSERT_EQ(image.pixels.type(), CV_32FC4);
    EXPECT_EQ(image.pixels.at<cv::Vec4f>(0, 1), cv::Vec4f(10, 100, 1000, 2));
}

TEST(Exr, LuminanceIsGreyAndOtherChannelsAreLeftAside) {
    const TemporaryFolder folder;
    store_exr(folder / "a.exr", {"Y", "Z", "depth.V"}, Imf::FLOAT, {{0, 0}, {1, 0}});
    const Image image = read_image(folder / "a.exr");
    ASSERT_EQ(image.pixels.type(), CV_32FC1);
    EXPECT_EQ(image.pixels.at<float>(0, 1), 2);
}

TEST(Exr, WithoutPlainColourIsRefused) {
    const TemporaryFolder folder;
    store_exr(folder / "a.exr", {"diffuse.R", "diffuse.G", "diffuse.B"}, Imf::HALF, {{0, 0}, {1, 0}});
    EXPECT_THAT(refusal([&] { read_image(folder / "a.exr"); }), HasSubstr("no plain R, G, B or Y"));
    store_exr(folder / "b.exr", {"Y", "RY", "BY"}, Imf::HALF, {{0, 0}, {1, 0}});
    EXPECT_THAT(refusal([&] { read_image(folder / "b.exr"); }), HasSubstr("no plain R, G, B or Y"));
}

TEST(Exr, WritesMultipliedAlphaForOthers) {
    const TemporaryFolder folder;
    Image image{cv::Mat(1, 1, CV_32FC4), {}};
    image.pixels.at<cv::Vec4f>(0, 0) = cv::Vec4f(0.5f, 1, 4, 0.25f);
    write_image(image, folder / "a.exr");
    Imf::InputFile file((folder / "a.exr").c_str());
    float values[4] = {};
    const char* names[4] = {"R", "G", "B", "A"};
    Imf::FrameBuffer frame;
    for (int c = 0; c < 4; ++c)
        frame.insert(names[c], Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(&values[c]), 4, 4));
    file.setFrameBuffer(frame);
    file.readPixels(0);
    EXPECT_EQ(values[0], 0.125f);
    EXPECT_EQ(values[1], 0.25f);
    EXPECT_EQ(values[2], 1.0f);
    EXPECT_EQ(values[3], 0.25f);
}

}  // namespace
}  // namespace puppetwarp
