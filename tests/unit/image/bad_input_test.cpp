#include <puppetwarp/image/read.h>
#include <puppetwarp/image/write.h>

#include "test_pictures.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstring>
#include <fstream>
#include <future>

#include <sys/stat.h>
#include <unistd.h>

namespace puppetwarp {
namespace {

using test::file_bytes;
using test::noise;
using test::refusal;
using test::store;
using test::TemporaryFolder;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

class BadInput : public testing::Test {
protected:
    std::string read(const std::string& name) {
        return refusal([&] { read_image(folder / name); });
    }
    std::string read_header(const std::string& name) {
        return refusal([&] { read_image_info(folder / name); });
    }
    TemporaryFolder folder;
};

TEST_F(BadInput, MissingFile) {
    EXPECT_THAT(read("none.png"), HasSubstr("none.png: no such file"));
    EXPECT_THAT(read_header("none.png"), HasSubstr("no such file"));
}

TEST_F(BadInput, Folder) {
    std::filesystem::create_directory(folder / "a.png");
    EXPECT_THAT(read("a.png"), HasSubstr("is a folder"));
}

TEST_F(BadInput, PipeIsRefusedAtOnce) {
    ASSERT_EQ(::mkfifo((folder / "a.png").c_str(), 0600), 0);
    auto outcome = std::async(std::launch::async, [&] { return read("a.png"); });
    if (outcome.wait_for(std::chrono::seconds(20)) != std::future_status::ready) {
        // Someone waits for a writer: be one, so that the test ends.
        std::ofstream(folder / "a.png") << "x";
        FAIL() << "a pipe holds the reader";
    }
    EXPECT_THAT(outcome.get(), HasSubstr("is not a regular file"));
}

TEST_F(BadInput, Device) {
    EXPECT_THAT(refusal([] { read_image("/dev/null"); }), HasSubstr("/dev/null: is not a regular file"));
}

TEST_F(BadInput, EmptyFile) {
    store(folder / "a.png", "");
    EXPECT_THAT(read("a.png"), HasSubstr("the file is empty"));
}

TEST_F(BadInput, FileWithoutPermission) {
    store(folder / "a.png", "x");
    ::chmod((folder / "a.png").c_str(), 0);
    ::chmod(folder.path().c_str(), 0755);
    const bool root = ::geteuid() == 0;
    constexpr uid_t nobody = 65534;
    if (root) {
        ASSERT_EQ(::seteuid(nobody), 0);
    }
    const std::string message = read("a.png");
    if (root) {
        ASSERT_EQ(::seteuid(0), 0);
    }
    EXPECT_THAT(message, HasSubstr("Permission denied"));
}

TEST_F(BadInput, NotAPicture) {
    store(folder / "a.png", "<html><body>404 Not Found</body></html>");
    EXPECT_THAT(read("a.png"), HasSubstr("is not a picture of a known format"));
    store(folder / "b.jpg", "#!/bin/sh\necho hello\n");
    EXPECT_THAT(read("b.jpg"), HasSubstr("is not a picture of a known format"));
    store(folder / "c.csv", "1,2,3\n4,5,6\n");
    EXPECT_THAT(read("c.csv"), HasSubstr("is not a picture of a known format"));
}

TEST_F(BadInput, DocumentsAndScriptsAreNotInterpreted) {
    const std::string svg =
        "<svg xmlns='http://www.w3.org/2000/svg' width='8' height='8'><rect width='8' height='8'/></svg>";
    store(folder / "a.svg", svg);
    store(folder / "svg.png", "<?xml version='1.0'?>" + svg);
    store(folder / "a.pdf",
          "%PDF-1.4\n1 0 obj<</Type/Catalog/Pages 2 0 R>>endobj\n2 0 obj<</Type/Pages/Kids[]/Count 0>>endobj\n"
          "trailer<</Root 1 0 R>>\n%%EOF");
    store(folder / "a.mvg",
          "push graphic-context\nviewbox 0 0 8 8\nfill 'url(https://example.com/a.png)'\npop graphic-context\n");
    store(folder / "a.ps", "%!PS-Adobe-3.0\nshowpage\n");
    store(folder / "a.xpm", "/* XPM */\nstatic char *a[] = {\"1 1 1 1\",\"a c #000\",\"a\"};\n");
    for (const char* name : {"a.svg", "svg.png", "a.pdf", "a.mvg", "a.ps", "a.xpm"})
        EXPECT_THAT(read(name), HasSubstr("is not a picture of a known format")) << name;
}

TEST_F(BadInput, EveryFormatSaysThatItIsTruncated) {
    const cv::Mat colour = noise(64, 64, CV_8U, 3, 1);
    for (const char* name : {"a.png", "a.jpg", "a.tif", "a.webp", "a.ppm", "a.gif", "a.jp2"}) {
        test::vips_store(colour, (folder / name).string());
        const std::string whole = file_bytes(folder / name);
        for (const double share : {0.2, 0.5, 0.9}) {
            const std::string cut = "cut" + std::string(name);
            store(folder / cut, whole.substr(0, static_cast<std::size_t>(static_cast<double>(whole.size()) * share)));
            EXPECT_THAT(read(cut), HasSubstr("the file is truncated or damaged")) << name << " cut to " << share;
        }
    }
    write_image({noise(64, 64, CV_32F, 3, 1), {}}, folder / "a.exr");
    const std::string whole = file_bytes(folder / "a.exr");
    for (const double share : {0.01, 0.2, 0.5, 0.9}) {
        store(folder / "cut.exr", whole.substr(0, static_cast<std::size_t>(static_cast<double>(whole.size()) * share)));
        EXPECT_THAT(read("cut.exr"), HasSubstr("the file is truncated or damaged")) << share;
    }
}

TEST_F(BadInput, WrongChecksumOfAPng) {
    std::string png = test::png_file(2, 1, 8, 0, std::string("\0\x10\x20", 3));
    png[png.find("IDAT") + 8] ^= 0x10;
    store(folder / "a.png", png);
    EXPECT_THAT(read("a.png"), HasSubstr("the file is truncated or damaged"));
}

TEST_F(BadInput, MessagesAreOneCleanLine) {
    store(folder / "a.png", test::png_file(4, 4, 8, 2, "").substr(0, 40));
    store(folder / "b.jpg", "\xff\xd8\xff\xe0 and then nothing");
    for (const char* name : {"a.png", "b.jpg"}) {
        EXPECT_THAT(read(name), AllOf(StartsWith((folder / name).string() + ": "), Not(HasSubstr("\n")),
                                      Not(HasSubstr("load")), Not(HasSubstr("vips")), Not(HasSubstr("Vips"))));
    }
}

// 30000 x 30000 RGBA in a small file: refused by its header, with room for neither 3.6 GB nor 25 seconds.
TEST_F(BadInput, PictureOverTheLimitIsRefusedByItsHeader) {
    store(folder / "bomb.png", test::png_file(30000, 30000, 8, 6, std::string(1000, '\0')));
    for (const std::string& message : {read("bomb.png"), read_header("bomb.png")})
        EXPECT_THAT(message, AllOf(HasSubstr("30000 x 30000"), HasSubstr("--max-pixels")));
    store(folder / "bomb.ppm", "P6 100000 100000 255\n");
    EXPECT_THAT(read("bomb.ppm"), HasSubstr("100000 x 100000"));
}

TEST_F(BadInput, TheLimitIsInclusive) {
    write_image({noise(10, 10, CV_8U, 1, 1), {}}, folder / "a.png");
    EXPECT_NO_THROW(read_image(folder / "a.png", {.max_pixels = 100}));
    EXPECT_THAT(refusal([&] { read_image(folder / "a.png", {.max_pixels = 99}); }), HasSubstr("10 x 10"));
    write_image({noise(10, 10, CV_32F, 1, 1), {}}, folder / "a.exr");
    EXPECT_THAT(refusal([&] { read_image(folder / "a.exr", {.max_pixels = 99}); }), HasSubstr("10 x 10"));
}

TEST_F(BadInput, MoreThanFourChannels) {
    store(folder / "a.tif", test::tiff_file(2, 1, 8, 6, 2, std::string(12, 'x'), {}));
    EXPECT_THAT(read("a.tif"), HasSubstr("it has 6 channels"));
}

TEST_F(BadInput, SignedNumbers) {
    store(folder / "a.tif", test::tiff_file(2, 1, 16, 1, 1, std::string(4, 'x'), {{339, 3, 2}}));
    EXPECT_THAT(read("a.tif"), HasSubstr("neither unsigned whole numbers nor 32-bit floats"));
}

TEST_F(BadInput, LibrariesStaySilent) {
    testing::internal::CaptureStderr();
    testing::internal::CaptureStdout();
    store(folder / "a.png", test::png_file(4, 4, 8, 2, std::string(5, '\0'), test::png_chunk("iCCP", "nonsense")));
    read("a.png");
    store(folder / "b.tif", test::tiff_file(4, 4, 8, 3, 2, std::string(10, 'x'), {{65000, 3, 1}, {320, 3, 0}}));
    read("b.tif");
    store(folder / "c.jpg", "\xff\xd8\xff\xe0 and then nothing");
    read("c.jpg");
    const std::string said = testing::internal::GetCapturedStderr() + testing::internal::GetCapturedStdout();
    EXPECT_EQ(said, "");
}

// A name with what libvips takes for options, and one with spaces and other alphabets.
TEST_F(BadInput, StrangeNamesAreJustNames) {
    for (const char* name : {"a[page=7].png", "b [shrink=2].png", "é 日本 '\".png", "-.png", "%s.png"}) {
        const Image image{noise(5, 4, CV_8U, 3, 1), {}};
        write_image(image, folder / name);
        EXPECT_TRUE(test::same(read_image(folder / name).pixels, image.pixels)) << name;
    }
}

TEST_F(BadInput, AFileThatChangedGivesItsNewPixels) {
    const Image first{noise(8, 8, CV_8U, 3, 1), {}};
    const Image second{noise(8, 8, CV_8U, 3, 2), {}};
    write_image(first, folder / "a.png");
    EXPECT_TRUE(test::same(read_image(folder / "a.png").pixels, first.pixels));
    write_image(second, folder / "a.png");
    EXPECT_TRUE(test::same(read_image(folder / "a.png").pixels, second.pixels));
}

}  // namespace
}  // namespace puppetwarp
