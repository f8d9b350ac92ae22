// Maps in files: what other programs find there, what comes back, and what other programs' maps come to.
#include "scenes.h"
#include "support/full_disk.h"
#include "support/message_of.h"
#include "support/run_command.h"

#include <puppetwarp/base/errors.h>
#include <puppetwarp/base/threads.h>
#include <puppetwarp/image/read.h>
#include <puppetwarp/image/write.h>
#include <puppetwarp/warp/displacement_file.h>

#include <ImfChannelList.h>
#include <ImfDoubleAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <ImfOutputFile.h>

#include <half.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

namespace puppetwarp::testing {
namespace {

using ::testing::HasSubstr;
using tests::bytes_of;
using tests::put_bytes;

constexpr float nowhere = std::numeric_limits<float>::quiet_NaN();

// Displacements drawn at random over a canvas that lies beside the source's corner, some pixels showing nothing.
DisplacementMap random_map(Random& random, double scale = 1) {
    DisplacementMap map{{{-3, 2, 31, 23}, scale, 40, 30}, cv::Mat(23, 31, CV_32FC3)};
    for (int y = 0; y < 23; ++y) {
        for (int x = 0; x < 31; ++x) {
            auto& pixel = map.displacement.at<cv::Vec3f>(y, x);
            pixel = {static_cast<float>(uniform(random, -5, 5)), static_cast<float>(uniform(random, -5, 5)), 1};
            if (random() % 4 == 0) pixel = {nowhere, nowhere, 0};
            if (random() % 8 == 0) pixel = {-2, 3, 0.5F};
        }
    }
    return map;
}

bool same_map(const cv::Vec3f& a, const cv::Vec3f& b) {
    const auto same = [](float p, float q) { return p == q || (std::isnan(p) && std::isnan(q)); };
    return same(a[0], b[0]) && same(a[1], b[1]) && a[2] == b[2];
}

// Channels of an EXR file by OpenEXR itself.
cv::Mat exr_channel(const std::string& path, const std::string& name) {
    Imf::InputFile file(path.c_str());
    const Imath::Box2i& window = file.header().dataWindow();
    cv::Mat values(window.max.y - window.min.y + 1, window.max.x - window.min.x + 1, CV_32FC1);
    Imf::FrameBuffer frame;
    frame.insert(name, Imf::Slice::Make(Imf::FLOAT, values.ptr(), window, sizeof(float), values.step));
    file.setFrameBuffer(frame);
    file.readPixels(window.min.y, window.max.y);
    return values;
}

using Value = std::function<float(const std::string& channel, int x, int y)>;

// An EXR of another program, whose windows are the same.
void store_exr(const std::string& path, const std::vector<std::string>& channels, int width, int height,
               const Value& value, bool halves = false) {
    Imf::Header header(width, height);
    std::vector<std::vector<float>> floats(channels.size());
    std::vector<std::vector<half>> half_floats(channels.size());
    Imf::FrameBuffer frame;
    for (std::size_t c = 0; c < channels.size(); ++c) {
        const Imf::PixelType type = halves ? Imf::HALF : Imf::FLOAT;
        header.channels().insert(channels[c], Imf::Channel(type));
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                floats[c].push_back(value(channels[c], x, y));
                half_floats[c].emplace_back(floats[c].back());
            }
        }
        void* base = halves ? static_cast<void*>(half_floats[c].data()) : floats[c].data();
        const std::size_t size = halves ? sizeof(half) : sizeof(float);
        frame.insert(channels[c],
                     Imf::Slice(type, static_cast<char*>(base), size, size * static_cast<std::size_t>(width)));
    }
    Imf::OutputFile file(path.c_str(), header);
    file.setFrameBuffer(frame);
    file.writePixels(height);
}

// The identity of a picture of 8 x 4, as a program writes it that computes in 32-bit floats.
float identity(const std::string& channel, int x, int y) {
    if (channel == "R") return (static_cast<float>(x) + 0.5F) / 8.0F;
    if (channel == "G") return 1.0F - (static_cast<float>(y) + 0.5F) / 4.0F;
    return 0;
}

class MapFile : public ::testing::Test {
protected:
    std::string message_of_reading(const std::string& path) const {
        return message_of([&] { read_displacement(path, 8, 4); });
    }

    tests::TemporaryFolder folder;
};

TEST_F(MapFile, ExrHoldsAnStMapAndDisplacementsForCompositors) {
    Random random(51);
    const DisplacementMap map = random_map(random, 1.5);
    const std::string path = folder / "map.exr";
    write_displacement(map, path);
    const cv::Mat s = exr_channel(path, "R"), t = exr_channel(path, "G"), b = exr_channel(path, "B"),
                  a = exr_channel(path, "A"), right = exr_channel(path, "displacement.x"),
                  up = exr_channel(path, "displacement.y");
    for (int y = 0; y < 23; ++y) {
        for (int x = 0; x < 31; ++x) {
            const auto& d = map.displacement.at<cv::Vec3f>(y, x);
            ASSERT_EQ(a.at<float>(y, x), d[2]);
            ASSERT_EQ(b.at<float>(y, x), std::isnan(d[0]) ? 0 : 1);
            if (std::isnan(d[0])) {
                for (const cv::Mat& channel : {s, t, right, up}) ASSERT_EQ(channel.at<float>(y, x), 0);
                continue;
            }
            // In pixels of the source, whose rows count downwards here and upwards there.
            const double from_x = (-3 + x + 0.5) / 1.5 + d[0], from_y = (2 + y + 0.5) / 1.5 + d[1];
            ASSERT_NEAR(s.at<float>(y, x), from_x / 40, 1e-7);
            ASSERT_NEAR(t.at<float>(y, x), 1 - from_y / 30, 1e-7);
            ASSERT_EQ(right.at<float>(y, x), d[0]);
            ASSERT_EQ(up.at<float>(y, x), -d[1]);
        }
    }
    const Imf::InputFile file(path.c_str());
    EXPECT_EQ(file.header().dataWindow(), Imath::Box2i({-3, 2}, {27, 24}));
    EXPECT_EQ(file.header().displayWindow(), Imath::Box2i({0, 0}, {59, 44}));
    const auto number = [&](const char* name) {
        return file.header().typedAttribute<Imf::DoubleAttribute>(name).value();
    };
    EXPECT_EQ(number("puppetwarp:sourceWidth"), 40);
    EXPECT_EQ(number("puppetwarp:sourceHeight"), 30);
    EXPECT_EQ(number("puppetwarp:scale"), 1.5);
}

TEST_F(MapFile, TiffHoldsTheStMapAsFourFloats) {
    Random random(52);
    const DisplacementMap map = random_map(random);
    for (const char* name : {"map.tif", "MAP.TIFF"}) {
        write_displacement(map, folder / name);
        const cv::Mat pixels = read_image(folder / name).pixels;
        ASSERT_EQ(pixels.type(), CV_32FC4);
        for (int y = 0; y < 23; ++y) {
            for (int x = 0; x < 31; ++x) {
                const auto& d = map.displacement.at<cv::Vec3f>(y, x);
                const auto& p = pixels.at<cv::Vec4f>(y, x);
                if (std::isnan(d[0])) {
                    ASSERT_EQ(p, cv::Vec4f(0, 0, 0, 0));
                    continue;
                }
                ASSERT_NEAR(p[0], (-3 + x + 0.5 + d[0]) / 40, 1e-7);
                ASSERT_NEAR(p[1], 1 - (2 + y + 0.5 + d[1]) / 30, 1e-7);
                ASSERT_EQ(p[2], 1);
                ASSERT_EQ(p[3], d[2]);
            }
        }
    }
}

TEST_F(MapFile, ExrGivesEveryBitBack) {
    Random random(53);
    for (const double scale : {1.0, 0.37}) {
        for (const int compression : {0, 1, 9}) {
            const DisplacementMap map = random_map(random, scale);
            write_displacement(map, folder / "map.exr", {.compression = compression});
            const StoredDisplacement stored = read_displacement(folder / "map.exr", 1000, 500);
            EXPECT_TRUE(stored.knows_source);
            EXPECT_EQ(stored.map.plane.source_width, 40);
            EXPECT_EQ(stored.map.plane.source_height, 30);
            EXPECT_EQ(stored.map.plane.scale, scale);
            EXPECT_EQ(stored.map.plane.canvas.x, -3);
            EXPECT_EQ(stored.map.plane.canvas.y, 2);
            for (int y = 0; y < 23; ++y) {
                for (int x = 0; x < 31; ++x) {
                    ASSERT_TRUE(
                        same_map(stored.map.displacement.at<cv::Vec3f>(y, x), map.displacement.at<cv::Vec3f>(y, x)));
                }
            }
        }
    }
}

// 8 million places of a picture 8000 pixels wide, of which whole-pixel moves come back whole.
TEST_F(MapFile, StMapsAloneKeepPlacesToAFractionOfAPixel) {
    DisplacementMap map{{{0, 0, 8000, 4}, 1, 8000, 6000}, cv::Mat(4, 8000, CV_32FC3)};
    Random random(54);
    for (int x = 0; x < 8000; ++x) {
        map.displacement.at<cv::Vec3f>(0, x) = {0, 0, 1};
        map.displacement.at<cv::Vec3f>(1, x) = {-17, 3000, 1};
        map.displacement.at<cv::Vec3f>(2, x) = {0.25F, 0.5F, 1};
        map.displacement.at<cv::Vec3f>(3, x) = {static_cast<float>(uniform(random, -9, 9)), 2000.3F, 1};
    }
    write_displacement(map, folder / "map.tif");
    const StoredDisplacement stored = read_displacement(folder / "map.tif", 8000, 6000);
    EXPECT_FALSE(stored.knows_source);
    EXPECT_NEAR(stored.map.rounding_px, 2.4e-4, 1e-5);
    for (int y = 0; y < 4; ++y) {
        for (int x = 0; x < 8000; ++x) {
            const auto& a = stored.map.displacement.at<cv::Vec3f>(y, x);
            const auto& b = map.displacement.at<cv::Vec3f>(y, x);
            if (y < 2) {
                ASSERT_EQ(a, b) << x;
            } else {
                // Near a pixel's centre the centre itself is taken.
                ASSERT_LT(std::abs(a[0] - b[0]), 1.2e-3) << x;
                ASSERT_LT(std::abs(a[1] - b[1]), 1.2e-3) << x;
            }
        }
    }
}

TEST_F(MapFile, TheSameBytesForAnyNumberOfThreads) {
    Random random(55);
    const int before = thread_count();
    const Image image = random_image(200, 300, CV_8UC4, random, Alpha::patches);
    const TriangleMesh rest = grid_mesh(-2, -2, 202, 302, 9, 7, random);
    const DisplacementRows rows(image, {}, rest, jittered(rest.V, 9, random));
    Progress progress;
    for (const char* name : {"map.exr", "map.tif"}) {
        std::string first;
        for (const int threads : {1, 2, 7}) {
            set_thread_count(threads);
            write_displacement(rows, folder / name, {}, progress);
            const std::string bytes = bytes_of(folder / name);
            EXPECT_TRUE(first.empty() || bytes == first) << name << " with " << threads << " threads";
            first = bytes;
        }
    }
    set_thread_count(before);
}

TEST_F(MapFile, MapsOfOtherProgramsAreReadAsStMaps) {
    const std::string path = folder / "map.exr";
    // Without alpha, with an alpha that nobody set, with other channels beside.
    for (const std::vector<std::string>& channels :
         {std::vector<std::string>{"R", "G"}, {"R", "G", "B", "A"}, {"G", "R", "Z", "motion.x"}}) {
        store_exr(path, channels, 8, 4, identity);
        const StoredDisplacement stored = read_displacement(path, 8, 4);
        EXPECT_FALSE(stored.knows_source);
        for (int y = 0; y < 4; ++y) {
            for (int x = 0; x < 8; ++x) ASSERT_EQ(stored.map.displacement.at<cv::Vec3f>(y, x), cv::Vec3f(0, 0, 1));
        }
    }
    // Alpha that is set somewhere counts.
    store_exr(path, {"R", "G", "A"}, 8, 4, [](const std::string& channel, int x, int y) {
        return channel == "A" ? static_cast<float>(x) / 4 : identity(channel, x, y);
    });
    const cv::Mat shown = read_displacement(path, 8, 4).map.displacement;
    EXPECT_TRUE(std::isnan(shown.at<cv::Vec3f>(2, 0)[0]));
    EXPECT_EQ(shown.at<cv::Vec3f>(2, 0)[2], 0);
    EXPECT_EQ(shown.at<cv::Vec3f>(2, 1), cv::Vec3f(0, 0, 0.25F));
    EXPECT_EQ(shown.at<cv::Vec3f>(2, 7), cv::Vec3f(0, 0, 1));
    // Drawn on a picture of another size they mean the same shares of it.
    const cv::Mat larger = read_displacement(path, 800, 400).map.displacement;
    EXPECT_NEAR(larger.at<cv::Vec3f>(2, 7)[0], 750 - 7.5, 1e-3);
    EXPECT_NEAR(larger.at<cv::Vec3f>(2, 7)[1], 250 - 2.5, 1e-3);
}

TEST_F(MapFile, NumbersThatAreNoPlacesShowNothing) {
    const std::string path = folder / "map.exr";
    store_exr(path, {"R", "G"}, 8, 4, [](const std::string& channel, int x, int y) {
        if (x == 1 && channel == "R") return nowhere;
        if (x == 2 && channel == "G") return std::numeric_limits<float>::infinity();
        if (x == 3) return 3e38F;
        return identity(channel, x, y);
    });
    const cv::Mat map = read_displacement(path, 1000, 1000).map.displacement;
    for (const int x : {1, 2, 3}) EXPECT_TRUE(std::isnan(map.at<cv::Vec3f>(1, x)[0])) << x;
    EXPECT_FALSE(std::isnan(map.at<cv::Vec3f>(1, 0)[0]));
}

TEST_F(MapFile, HalfFloatsAndSixteenBitsAreReadAndTheirRoundingSaid) {
    store_exr(folder / "map.exr", {"R", "G"}, 8, 4, identity, true);
    const StoredDisplacement halves = read_displacement(folder / "map.exr", 4000, 2000);
    EXPECT_NEAR(halves.map.rounding_px, 4000.0 / 4096, 1e-9);
    Image words{cv::Mat(4, 8, CV_16UC3), {}};
    for (int y = 0; y < 4; ++y) {
        for (int x = 0; x < 8; ++x) {
            words.pixels.at<cv::Vec3w>(y, x) = {static_cast<ushort>(std::lround(65535 * (x + 0.5) / 8)),
                                                static_cast<ushort>(std::lround(65535 * (1 - (y + 0.5) / 4))), 0};
        }
    }
    write_image(words, folder / "map.png");
    const StoredDisplacement png = read_displacement(folder / "map.png", 4000, 2000);
    EXPECT_NEAR(png.map.rounding_px, 4000.0 / 131070, 1e-9);
    EXPECT_NEAR(png.map.displacement.at<cv::Vec3f>(3, 7)[0], 3750 - 7.5, 0.04);
    EXPECT_NEAR(png.map.displacement.at<cv::Vec3f>(3, 7)[1], 1750 - 3.5, 0.02);
}

// A compositor that changed the map left our displacements as they were: red and green decide.
TEST_F(MapFile, RedAndGreenDecideWhereDisplacementsDisagree) {
    const std::string path = folder / "map.exr";
    const DisplacementMap map{{{0, 0, 8, 4}, 1, 8, 4}, cv::Mat(4, 8, CV_32FC3, cv::Scalar(1.3, 0.2, 1))};
    write_displacement(map, path);
    Imf::Header header;
    cv::Mat values(4, 8, CV_32FC(6));
    const char* names[] = {"R", "G", "B", "A", "displacement.x", "displacement.y"};
    Imf::FrameBuffer frame;
    for (std::size_t c = 0; c < 6; ++c) {
        frame.insert(names[c], Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(values.ptr()) + 4 * c, 24, 24 * 8));
    }
    {
        Imf::InputFile file(path.c_str());
        header = file.header();
        file.setFrameBuffer(frame);
        file.readPixels(0, 3);
    }
    values.ptr<float>(1)[6 * 2] += 0.5F / 8;  // half a pixel
    {
        Imf::OutputFile changed(path.c_str(), header);
        changed.setFrameBuffer(frame);
        changed.writePixels(4);
    }
    const cv::Mat read = read_displacement(path, 8, 4).map.displacement;
    EXPECT_NEAR(read.at<cv::Vec3f>(1, 2)[0], 1.8, 1e-6);
    EXPECT_EQ(read.at<cv::Vec3f>(1, 3), cv::Vec3f(1.3F, 0.2F, 1));
}

TEST_F(MapFile, WhatIsNoMapIsRefusedWithAReason) {
    const auto zero = [](const std::string&, int, int) { return 0.0F; };
    store_exr(folder / "depth.exr", {"Z", "diffuse.R"}, 8, 4, zero);
    EXPECT_THAT(message_of_reading(folder / "depth.exr"),
                ::testing::AllOf(HasSubstr("no channels R and G"), HasSubstr("Z, diffuse.R")));
    write_image({cv::Mat(4, 8, CV_8UC3, cv::Scalar::all(9)), {}}, folder / "bytes.png");
    EXPECT_THAT(message_of_reading(folder / "bytes.png"), HasSubstr("8 bits"));
    write_image({cv::Mat(4, 8, CV_32FC1, cv::Scalar::all(0.5)), {}}, folder / "grey.tif");
    EXPECT_THAT(message_of_reading(folder / "grey.tif"), HasSubstr("one channel"));
    put_bytes(folder / "text.exr", "no picture");
    EXPECT_NE(message_of_reading(folder / "text.exr"), "");
    EXPECT_THAT(message_of_reading(folder / "none.exr"), HasSubstr("no such file"));
    Random random(57);
    write_displacement(random_map(random), folder / "map.exr");
    const std::string whole = bytes_of(folder / "map.exr");
    for (const std::size_t length : {std::size_t{100}, whole.size() / 2, whole.size() - 10}) {
        put_bytes(folder / "cut.exr", whole.substr(0, length));
        EXPECT_THAT(message_of_reading(folder / "cut.exr"), HasSubstr("cut.exr")) << length;
    }
    EXPECT_THAT(message_of([&] { read_displacement(folder / "map.exr", 8, 4, {100}); }), HasSubstr("more than 100"));
}

TEST_F(MapFile, NamesThatCannotHoldAMapAreRefused) {
    for (const char* name : {"map.png", "map", "map.exr.jpg", "map.pfm"}) {
        EXPECT_THAT(message_of([&] { require_displacement_name(folder / name); }), HasSubstr(".exr, .tif")) << name;
    }
    EXPECT_THAT(message_of([&] { require_displacement_name("-"); }), HasSubstr("stream"));
    EXPECT_THAT(message_of([&] { require_displacement_name("/dev/stdout"); }), HasSubstr("stream"));
    for (const char* name : {"map.exr", "map.tif", "map.TIFF"})
        EXPECT_NO_THROW(require_displacement_name(folder / name));
}

TEST_F(MapFile, AFullDiskIsAFaultOfTheMachineAndTheOldFileStaysWhole) {
    Random random(58);
    DisplacementMap map{{{0, 0, 300, 200}, 1, 300, 200}, cv::Mat(200, 300, CV_32FC3)};
    for (int y = 0; y < 200; ++y) {
        for (int x = 0; x < 300; ++x) {
            map.displacement.at<cv::Vec3f>(y, x) = {static_cast<float>(uniform(random, -5, 5)),
                                                    static_cast<float>(uniform(random, -5, 5)), 1};
        }
    }
    for (const char* name : {"map.exr", "map.tif"}) {
        for (const rlim_t room : {0, 1000, 100'000}) {
            put_bytes(folder / name, "the old file");
            bool fault = false;
            {
                const tests::FullDisk disk(room);
                try {
                    write_displacement(map, folder / name);
                } catch (const MachineFault& error) {
                    fault = error.subject() == folder / name;
                }
            }
            EXPECT_TRUE(fault) << name << " with room for " << room;
            EXPECT_EQ(bytes_of(folder / name), "the old file") << name;
        }
        std::filesystem::remove(folder / name);
        EXPECT_TRUE(std::filesystem::is_empty(folder.path())) << "something is left behind";
    }
}

TEST_F(MapFile, WritingCanBeCancelledAndLeavesNothing) {
    struct Cancelling : Progress {
        bool cancelled() const override { return steps <= 0; }
        int steps = 3;

    protected:
        void show(std::string_view stage, double) override {
            EXPECT_EQ(stage, "write");
            --steps;
        }
    } cancelling;
    Random random(59);
    const Image image{cv::Mat(400, 50, CV_8UC3), {}};
    const TriangleMesh rest = grid_mesh(0, 0, 50, 400, 1, 1, random);
    const DisplacementRows rows(image, {}, rest, rest.V);
    EXPECT_THROW(write_displacement(rows, folder / "map.exr", {}, cancelling), Cancelled);
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace puppetwarp::testing
