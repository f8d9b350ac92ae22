// Pictures whose rows are made while they are written.
#include <puppetwarp/base/errors.h>
#include <puppetwarp/base/progress.h>
#include <puppetwarp/image/picture_rows.h>
#include <puppetwarp/image/write.h>

#include "test_pictures.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <stdexcept>

namespace puppetwarp {
namespace {

using test::file_bytes;
using test::noise;
using test::TemporaryFolder;

constexpr const char* all_names[] = {"a.png", "a.jpg", "a.tif", "a.webp", "a.exr", "a.ppm", "a.pgm", "a.pfm"};

// Each call gives memory of its own, as what is painted band by band does.
PictureRows copies_of(const Image& image) {
    PictureRows rows = rows_of(image);
    rows.rows = [pixels = image.pixels](int first, int last) {
        EXPECT_LE(0, first);
        EXPECT_LT(first, last);
        EXPECT_LE(last, pixels.rows);
        return pixels.rowRange(first, last).clone();
    };
    return rows;
}

TEST(PictureRows, MakeTheFileOfTheWholePicture) {
    const TemporaryFolder folder;
    for (const char* name : all_names) {
        for (const int depth : {CV_8U, CV_16U, CV_32F}) {
            for (int channels = 1; channels <= 4; ++channels) {
                const Image image{noise(61, 600, depth, channels, 7), {}};  // higher than any writer's piece
                write_image(image, folder / name);
                const std::string whole = file_bytes(folder / name);
                write_rows(copies_of(image), folder / name);
                EXPECT_TRUE(file_bytes(folder / name) == whole) << name << " " << depth << " " << channels;
            }
        }
    }
}

TEST(PictureRows, OfAPngOfSeveralPiecesAreReadBack) {
    const TemporaryFolder folder;
    const Image image{noise(9001, 1500, CV_8U, 3, 7), {}};  // a piece is 4 MB a thread
    write_rows(copies_of(image), folder / "a.png", {.compression = 0});
    EXPECT_TRUE(test::same(test::vips_pixels(folder / "a.png"), image.pixels));
}

TEST(PictureRows, KeepTheMetadata) {
    const TemporaryFolder folder;
    const Image image{noise(30, 20, CV_8U, 3, 7),
                      {test::icc_profile("p3"), test::exif_block(1), {'<', '/', '>'}, 3, 4}};
    for (const char* name : all_names) {
        write_image(image, folder / name);
        const std::string whole = file_bytes(folder / name);
        write_rows(copies_of(image), folder / name);
        EXPECT_TRUE(file_bytes(folder / name) == whole) << name;
    }
}

TEST(PictureRows, AreAskedForOneCallAtATime) {
    const TemporaryFolder folder;
    const Image image{noise(500, 2000, CV_8U, 3, 7), {}};
    for (const char* name : all_names) {
        std::atomic<int> inside = 0;
        bool together = false;
        PictureRows rows = rows_of(image);
        rows.rows = [&](int first, int last) {
            together = together || ++inside > 1;
            cv::Mat made = image.pixels.rowRange(first, last).clone();
            --inside;
            return made;
        };
        write_rows(rows, folder / name);
        EXPECT_FALSE(together) << name;
    }
}

TEST(PictureRows, WhatMakingThemThrowsEndsTheWritingAndTheOldFileStays) {
    const TemporaryFolder folder;
    const Image image{noise(3000, 1400, CV_8U, 3, 7), {}};
    for (const char* name : all_names) {
        for (const int good : {0, 1}) {
            test::store(folder / name, "the old file");
            PictureRows rows = rows_of(image);
            int calls = 0;
            rows.rows = [&](int first, int last) {
                // WebP asks once, for everything; PFM begins at the end.
                if (calls++ == good || last == image.height()) throw Cancelled();
                return image.pixels.rowRange(first, last);
            };
            EXPECT_THROW(write_rows(rows, folder / name), Cancelled) << name << " after " << good;
            EXPECT_EQ(file_bytes(folder / name), "the old file") << name;
            EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1) << name;
            std::filesystem::remove(folder / name);
        }
    }
}

TEST(PictureRows, OfNoSizeOrOfFiveChannelsAreRefused) {
    const TemporaryFolder folder;
    const auto never = [](int, int) -> cv::Mat { throw std::logic_error("asked for rows"); };
    for (const PictureRows& bad : {PictureRows{0, 3, CV_8UC3, {}, never}, PictureRows{3, 0, CV_8UC3, {}, never},
                                   PictureRows{3, 3, CV_8UC(5), {}, never}, PictureRows{3, 3, CV_64FC3, {}, never}})
        EXPECT_THROW(write_rows(bad, folder / "a.png"), InvalidInput);
}

}  // namespace
}  // namespace puppetwarp
