// Pictures that are written whole or not at all, and with the same bytes whoever writes them.
#include <puppetwarp/base/threads.h>
#include <puppetwarp/image/read.h>
#include <puppetwarp/image/write.h>

#include "support/full_disk.h"
#include "test_pictures.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace puppetwarp {
namespace {

using test::file_bytes;
using test::noise;
using test::refusal;
using test::same;
using test::store;
using test::TemporaryFolder;
using testing::HasSubstr;
using tests::FullDisk;

constexpr const char* all_names[] = {"a.png", "a.jpg", "a.tif", "a.webp", "a.exr", "a.ppm", "a.pgm", "a.pfm"};

TEST(Output, AFullDiskIsAFaultOfTheMachineAndTheOldFileStaysWhole) {
    const TemporaryFolder folder;
    const Image image{noise(200, 200, CV_8U, 3, 1), {}};
    for (const char* name : all_names) {
        for (const rlim_t room : {0, 1000, 10'000}) {
            store(folder / name, "the old file");
            bool fault = false;
            {
                const FullDisk disk(room);
                try {
                    write_image(image, folder / name);
                } catch (const MachineFault& error) {
                    fault = error.subject() == (folder / name).string();
                }
            }
            EXPECT_TRUE(fault) << name << " with room for " << room;
            EXPECT_EQ(file_bytes(folder / name), "the old file") << name;
        }
        EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1)
            << "something is left behind";
        std::filesystem::remove(folder / name);
    }
}

TEST(Output, MissingFolderAndFolderAsTarget) {
    const TemporaryFolder folder;
    const Image image{noise(4, 4, CV_8U, 3, 1), {}};
    EXPECT_THAT(refusal([&] { write_image(image, folder / "none/a.png"); }), HasSubstr("does not exist"));
    std::filesystem::create_directory(folder / "a.png");
    EXPECT_THAT(refusal([&] { write_image(image, folder / "a.png"); }), HasSubstr("is a folder"));
}

TEST(Output, OptionsAndSizesOutOfRange) {
    const TemporaryFolder folder;
    const Image image{noise(4, 4, CV_8U, 3, 1), {}};
    EXPECT_THAT(refusal([&] { write_image(image, folder / "a.png", {.compression = 10}); }),
                HasSubstr("compression 10"));
    EXPECT_THAT(refusal([&] { write_image(image, folder / "a.jpg", {.quality = 101}); }), HasSubstr("quality 101"));
    EXPECT_THAT(refusal([&] { write_image({}, folder / "a.png"); }), HasSubstr("no picture"));
    const Image wide{cv::Mat(1, 16384, CV_8UC1, cv::Scalar(0)), {}};
    EXPECT_THAT(refusal([&] { write_image(wide, folder / "a.webp"); }), HasSubstr("16383"));
    const Image wider{cv::Mat(1, 65501, CV_8UC1, cv::Scalar(0)), {}};
    EXPECT_THAT(refusal([&] { write_image(wider, folder / "a.jpg"); }), HasSubstr("65500"));
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(Output, APipeGetsAPng) {
    const TemporaryFolder folder;
    const Image image{noise(300, 200, CV_8U, 4, 1), {}};
    ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
    std::string received;
    std::thread reader([&] { received = file_bytes(folder / "pipe"); });
    write_image(image, folder / "pipe");
    reader.join();
    store(folder / "a.png", received);
    EXPECT_TRUE(same(read_image(folder / "a.png").pixels, image.pixels));
    EXPECT_TRUE(std::filesystem::is_fifo(folder / "pipe"));
}

// What is open as a descriptor is written where it stands, a file behind it included, and stays open for others.
TEST(Output, AnOpenDescriptorIsWrittenWhereItStands) {
    const TemporaryFolder folder;
    const Image image{noise(30, 20, CV_8U, 3, 1), {}};
    const int descriptor = ::open((folder / "log").c_str(), O_RDWR | O_CREAT, 0600);
    ASSERT_GE(descriptor, 0);
    ASSERT_EQ(::write(descriptor, "head", 4), 4);
    std::filesystem::create_symlink("/proc/self/fd/" + std::to_string(descriptor), folder / "link");
    write_image(image, folder / "link");
    ASSERT_EQ(::write(descriptor, "tail", 4), 4);
    ::close(descriptor);
    write_image(image, folder / "a.png");
    EXPECT_EQ(file_bytes(folder / "log"), "head" + file_bytes(folder / "a.png") + "tail");
    EXPECT_TRUE(std::filesystem::is_symlink(folder / "link"));
}

TEST(Output, SameBytesForAnyNumberOfThreadsAndFromRunToRun) {
    const TemporaryFolder folder;
    const int threads = thread_count();
    for (const int depth : {CV_8U, CV_16U, CV_32F}) {
        // Large enough for several bands of the PNG writer; the others get a piece of it.
        Image large{noise(700, 500, depth, 4, 1), {}};
        large.pixels(cv::Rect(100, 0, 500, 400)).setTo(cv::Scalar::all(0.5 * large.full_value()));
        large.metadata.exif = test::exif_block(1);
        const Image small{large.pixels(cv::Rect(60, 350, 90, 130)), large.metadata};
        for (const char* name : all_names) {
            const Image& image = std::string(name) == "a.png" ? large : small;
            std::string first;
            for (const int count : {1, 2, 5, 2}) {
                set_thread_count(count);
                write_image(image, folder / name);
                const std::string bytes = file_bytes(folder / name);
                EXPECT_TRUE(first.empty() || bytes == first) << name << " with " << count << " threads";
                first = bytes;
                const Image back = read_image(folder / name);
                set_thread_count(1);
                EXPECT_TRUE(same(read_image(folder / name).pixels, back.pixels)) << name;
            }
        }
    }
    set_thread_count(threads);
}

}  // namespace
}  // namespace puppetwarp
