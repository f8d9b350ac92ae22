// The fuzzer's corpus, each file whole, cut anywhere, and with bytes changed.
#include <puppetwarp/image/read.h>

#include "test_pictures.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace puppetwarp {
namespace {

// Reads, or refuses with InvalidInput; header and pixels agree.
void probe(const std::filesystem::path& path) {
    const ReadOptions options{.max_pixels = 1 << 20};
    try {
        const ImageInfo info = read_image_info(path, options);
        const Image image = read_image(path, options);
        EXPECT_EQ(info.width, image.width());
        EXPECT_EQ(info.height, image.height());
        EXPECT_EQ(info.channels, image.pixels.channels());
    } catch (const InvalidInput& error) {
        EXPECT_NE(error.reason(), "");
    }
}

TEST(Corpus, IsReadWholeAndSurvivesDamage) {
    std::vector<std::filesystem::path> paths;
    for (const auto& entry : std::filesystem::directory_iterator(PUPPETWARP_SOURCE_DIR "/tests/fuzz/corpus/image"))
        paths.push_back(entry.path());
    std::sort(paths.begin(), paths.end());
    ASSERT_GE(paths.size(), 8u);
    const test::TemporaryFolder folder;
    std::mt19937 random(7);
    for (const auto& path : paths) {
        SCOPED_TRACE(path);
        testing::internal::CaptureStderr();
        EXPECT_NO_THROW(read_image(path));
        const std::string whole = test::file_bytes(path);
        for (int i = 0; i < 40; ++i) {
            std::string damaged = i % 2 == 0 ? whole.substr(0, random() % whole.size()) : whole;
            for (int k = 0; k < 1 + i / 8 && !damaged.empty(); ++k)
                damaged[random() % damaged.size()] = static_cast<char>(random());
            test::store(folder / "damaged", damaged);
            probe(folder / "damaged");
        }
        const std::string said = testing::internal::GetCapturedStderr();
        // dav1d, which decodes AVIF below libheif, writes to standard error and cannot be told not to.
        if (path.extension() != ".avif") {
            EXPECT_EQ(said, "");
        }
    }
}

}  // namespace
}  // namespace puppetwarp
