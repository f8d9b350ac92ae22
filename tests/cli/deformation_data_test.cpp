// The deformation as data, other scales and resolutions, on the command line.

#include "pictures.h"
#include "support/run_command.h"

#include <puppetwarp/image/read.h>
#include <puppetwarp/image/write.h>
#include <puppetwarp/mesh/mesh_file.h>

#include <opencv2/core.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <csignal>

#include <sys/resource.h>

namespace puppetwarp::tests {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using testing::HasSubstr;

class DeformationData : public testing::Test {
protected:
    DeformationData() {
        write_image(disc_picture(120, 100), disc);
        write_image(noise_picture(80, 60, CV_8UC3), photo);
    }

    // Warps the disc through two pins, one of them moved.
    CommandResult warp(std::vector<std::string> more) const {
        more.insert(more.begin(), {"warp", disc, "--pin", "45,50", "--pin", "75,50:82.3,44.8", "-o", out});
        return puppetwarp_command(more);
    }
    CommandResult through(const std::string& picture, const std::string& map,
                          std::vector<std::string> more = {}) const {
        more.insert(more.begin(), {"warp", picture, "--displacement-in", map, "-o", again});
        return puppetwarp_command(more);
    }

    static void expect_refused(const CommandResult& result, const std::string& mentions, int exit_code = 2) {
        EXPECT_EQ(result.exit_code, exit_code) << result.errors;
        EXPECT_THAT(result.errors, testing::StartsWith("puppetwarp: "));
        EXPECT_EQ(std::count(result.errors.begin(), result.errors.end(), '\n'), 1) << result.errors;
        EXPECT_THAT(result.errors, HasSubstr(mentions));
        EXPECT_EQ(result.output, "");
    }

    static cv::Mat pixels_of(const std::string& file) { return read_image(file).pixels; }

    TemporaryFolder folder;
    std::string disc = folder / "disc.png";
    std::string photo = folder / "photo.png";
    std::string out = folder / "out.png";
    std::string again = folder / "again.png";
};

TEST_F(DeformationData, AMapDrawsThePictureAgain) {
    for (const char* name : {"map.exr", "map.tif"}) {
        const std::string map = folder / name;
        ASSERT_EQ(warp({"--displacement", map, "--canvas", "grow"}).exit_code, 0);
        const CommandResult result = through(disc, map, {"--json"});
        ASSERT_EQ(result.exit_code, 0) << result.errors;
        cv::Mat difference;
        cv::absdiff(pixels_of(out), pixels_of(again), difference);
        EXPECT_LT(cv::countNonZero(difference.reshape(1) > 1), 30);  // where triangles meet
        const Json report = Json::parse(result.output);
        EXPECT_TRUE(report["method"].is_null());
        EXPECT_TRUE(report["energy"].is_null());
        EXPECT_EQ(report["canvas"]["width"], pixels_of(out).cols);
        EXPECT_EQ(report["scale"], 1);
        EXPECT_TRUE(report["timings_ms"].contains("warp"));
    }
}

TEST_F(DeformationData, WholePixelMovesComeBackToTheBit) {
    for (const int type : {CV_8UC3, CV_16UC4, CV_16UC1}) {
        write_image(noise_picture(90, 70, type), folder / "in.png");
        for (const char* name : {"map.exr", "map.tif"}) {
            ASSERT_EQ(puppetwarp_command({"warp", folder / "in.png", "--pin", "45,35:52,31", "-o", out,
                                          "--displacement", folder / name})
                          .exit_code,
                      0);
            ASSERT_EQ(through(folder / "in.png", folder / name).exit_code, 0);
            EXPECT_EQ(cv::norm(pixels_of(out), pixels_of(again), cv::NORM_INF), 0) << name << type;
            // What is behind, and what a format without alpha asks for, is the same as well.
            for (const std::string background : {"keep", "#4080c0"}) {
                ASSERT_EQ(puppetwarp_command({"warp", folder / "in.png", "--pin", "45,35:52,31", "-o", out,
                                              "--background", background})
                              .exit_code,
                          0);
                ASSERT_EQ(through(folder / "in.png", folder / name, {"--background", background}).exit_code, 0);
                EXPECT_EQ(cv::norm(pixels_of(out), pixels_of(again), cv::NORM_INF), 0) << name << type;
            }
        }
    }
}

TEST_F(DeformationData, TheSameBytesForAnyNumberOfThreads) {
    std::string first[4];
    for (const char* threads : {"1", "2", "7"}) {
        ASSERT_EQ(warp({"-j", threads, "--displacement", folder / "map.exr", "--mesh-out", folder / "mesh.obj",
                        "--scale", "1.3"})
                      .exit_code,
                  0);
        ASSERT_EQ(warp({"-j", threads, "--displacement", folder / "map.tif"}).exit_code, 0);
        ASSERT_EQ(through(disc, folder / "map.exr", {"-j", threads}).exit_code, 0);
        const std::string files[4] = {folder / "map.exr", folder / "map.tif", folder / "mesh.obj", again};
        for (int k = 0; k < 4; ++k) {
            const std::string bytes = bytes_of(files[k]);
            EXPECT_TRUE(first[k].empty() || bytes == first[k]) << files[k] << " with " << threads;
            first[k] = bytes;
        }
    }
}

TEST_F(DeformationData, TheMovedMeshIsWritten) {
    for (const char* name : {"mesh.obj", "mesh.off"}) {
        ASSERT_EQ(warp({"--mesh-out", folder / name}).exit_code, 0);
        const TriangleMesh moved = read_mesh(folder / name);
        EXPECT_GT(moved.V.col(0).maxCoeff(), 105);  // the right pin went there
    }
    EXPECT_THAT(bytes_of(folder / "mesh.obj"), HasSubstr("\nvt "));
    ASSERT_EQ(warp({"--mesh-out", folder / "mesh.svg", "--canvas", "140x120-5-7", "--scale", "2"}).exit_code, 0);
    EXPECT_THAT(bytes_of(folder / "mesh.svg"), HasSubstr("width=\"280\" height=\"240\" viewBox=\"-5 -7 140 120\""));
    ASSERT_EQ(puppetwarp_command({"mesh", disc, "-o", folder / "rest.obj"}).exit_code, 0);
    EXPECT_THAT(bytes_of(folder / "rest.obj"), HasSubstr("\nvt "));
}

TEST_F(DeformationData, ScaleAndAnotherResolution) {
    const CommandResult result = warp({"--scale", "2", "--json"});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_EQ(pixels_of(out).size(), cv::Size(240, 200));
    EXPECT_EQ(Json::parse(result.output)["scale"], 2);
    write_image(disc_picture(480, 400), folder / "large.png");
    const CommandResult large = warp({"--image", folder / "large.png", "--json", "--overlay", "handles"});
    ASSERT_EQ(large.exit_code, 0) << large.errors;
    EXPECT_EQ(pixels_of(out).size(), cv::Size(480, 400));
    EXPECT_EQ(Json::parse(large.output)["scale"], 4);
    EXPECT_EQ(pixels_of(out).at<cv::Vec4b>(44.8 * 4, 82.3 * 4), cv::Vec4b(255, 191, 0, 255));
    EXPECT_EQ(warp({"--image", folder / "large.png", "--scale", "0.25"}).exit_code, 0);
    EXPECT_EQ(pixels_of(out).size(), cv::Size(120, 100));
    // The map of a proxy draws the large picture as large as it is.
    ASSERT_EQ(warp({"--displacement", folder / "map.exr"}).exit_code, 0);
    ASSERT_EQ(through(folder / "large.png", folder / "map.exr").exit_code, 0);
    EXPECT_EQ(pixels_of(again).size(), cv::Size(480, 400));
}

TEST_F(DeformationData, NamesAndCombinationsThatCannotBe) {
    expect_refused(warp({"--displacement", folder / "map.png"}), ".exr, .tif");
    expect_refused(warp({"--displacement", "-"}), "stream");
    expect_refused(warp({"--displacement", "/dev/stdout"}), "stream");
    expect_refused(warp({"--displacement", folder / "nowhere/map.exr"}), "nowhere");
    expect_refused(warp({"--displacement", out}), ".exr, .tif");
    expect_refused(warp({"--mesh-out", folder / "mesh.png"}), ".svg");
    expect_refused(warp({"--mesh-out", disc}), ".svg");
    expect_refused(
        warp({"--displacement", folder / "x.exr", "--mesh-out", folder / "m.obj", "--report", folder / "m.obj"}),
        "two results");
    expect_refused(warp({"--scale", "0"}), "--scale");
    expect_refused(warp({"--scale", "nan"}), "--scale");
    expect_refused(warp({"--image", folder / "none.png"}), "none.png");
    expect_refused(warp({"--image", photo}), "80 x 60");
    ASSERT_FALSE(fs::exists(out));
    ASSERT_EQ(warp({"--displacement", folder / "map.exr"}).exit_code, 0);
    expect_refused(warp({"--displacement-in", folder / "map.exr"}), "--pin");
    for (const std::vector<std::string>& more : {std::vector<std::string>{"--pose", "rest"},
                                                 {"--method", "arap"},
                                                 {"--overlay", "mesh"},
                                                 {"--fail-on-fold"},
                                                 {"--mesh-out", folder / "m.obj"},
                                                 {"--displacement", folder / "n.exr"},
                                                 {"--image", disc}})
        expect_refused(through(disc, folder / "map.exr", more), more[0]);
    expect_refused(through(photo, folder / "map.exr"), "120 x 100");
    expect_refused(through(disc, folder / "none.exr"), "none.exr");
    expect_refused(through(disc, disc), "8 bits");
    expect_refused(through(disc, folder / "map.exr", {"--background", "pink"}), "pink");
    put_bytes(folder / "p.json", R"({"format": "puppetwarp", "version": 1, "image": "disc.png"})");
    expect_refused(through(folder / "p.json", folder / "map.exr"), "puppet file");
    expect_refused(
        puppetwarp_command({"warp", disc, "--displacement-in", folder / "map.tif", "-o", folder / "map.tif"}),
        "map.tif");
    const std::string before = bytes_of(folder / "map.exr");
    expect_refused(
        puppetwarp_command({"warp", disc, "--displacement-in", folder / "map.exr", "-o", folder / "map.exr"}),
        "--force");
    EXPECT_EQ(bytes_of(folder / "map.exr"), before);
    expect_refused(warp({"--image", folder / "map.exr", "--displacement", folder / "map.exr"}), "--force");
}

TEST_F(DeformationData, TooManyPixelsAreRefusedBeforeAnyWork) {
    // A JPEG that ends early: whoever decodes it complains of that.
    write_image(noise_picture(400, 300, CV_8UC3), folder / "whole.jpg");
    const std::string jpeg = bytes_of(folder / "whole.jpg");
    put_bytes(folder / "cut.jpg", jpeg.substr(0, jpeg.size() / 2));
    const auto with = [&](std::vector<std::string> more) {
        more.insert(more.begin(), {"warp", folder / "cut.jpg", "--pin", "60,50", "-o", out});
        return puppetwarp_command(more);
    };
    expect_refused(with({}), "truncated");
    expect_refused(with({"--canvas", "20000x20000+0+0"}), "20000 x 20000");
    expect_refused(with({"--canvas", "2000000000x2000000000+0+0"}), "canvas");
    expect_refused(with({"--canvas", "100x100+2000000000+0"}), "canvas");
    expect_refused(with({"--canvas", "200x200+0+0", "--max-pixels", "39999"}), "--max-pixels");
    expect_refused(with({"--scale", "100"}), "40000 x 30000");
    expect_refused(with({"--scale", "100", "--canvas", "grow"}), "40000 x 30000");
    expect_refused(with({"--scale", "2", "--max-pixels", "479999"}), "800 x 600");
    expect_refused(with({"--scale", "0.0001"}), "canvas");
    EXPECT_FALSE(fs::exists(out));
}

TEST_F(DeformationData, TargetsFarAwayAreRefusedOrCutOff) {
    const std::vector<std::string> far = {"warp", disc, "--pin", "45,50", "--pin", "75,50:100000,-300000", "-o", out};
    const auto with = [&](std::vector<std::string> more) {
        more.insert(more.begin(), far.begin(), far.end());
        return puppetwarp_command(more);
    };
    expect_refused(with({"--canvas", "grow", "--quiet"}), "canvas");
    EXPECT_FALSE(fs::exists(out));
    EXPECT_EQ(with({"--quiet"}).exit_code, 0);
    EXPECT_EQ(pixels_of(out).size(), cv::Size(120, 100));
}

TEST_F(DeformationData, StrictRefusesWhatAFormatCannotHold) {
    write_image(noise_picture(90, 70, CV_16UC3), folder / "deep.png");
    ASSERT_EQ(puppetwarp_command({"warp", folder / "deep.png", "--pin", "45,35:50,35", "-o", out, "--displacement",
                                  folder / "map.exr"})
                  .exit_code,
              0);
    const auto to = [&](const std::string& name, std::vector<std::string> more) {
        more.insert(more.begin(),
                    {"warp", folder / "deep.png", "--displacement-in", folder / "map.exr", "-o", folder / name});
        return puppetwarp_command(more);
    };
    const CommandResult lost = to("out.jpg", {"--json"});
    EXPECT_EQ(lost.exit_code, 0);
    EXPECT_THAT(lost.errors, testing::AllOf(HasSubstr("alpha"), HasSubstr("16 bits")));
    EXPECT_EQ(Json::parse(lost.output)["lost"].size(), 2u);
    fs::remove(folder / "out.jpg");
    for (const char* name : {"out.jpg", "out.webp", "out.ppm"}) {
        expect_refused(to(name, {"--strict"}), "cannot hold");
        EXPECT_FALSE(fs::exists(folder / name)) << name;
    }
    for (const char* name : {"out.png", "out.tif", "out.exr"}) EXPECT_EQ(to(name, {"--strict"}).exit_code, 0) << name;
}

// Whatever is written when the disk is full: exit code 3, and what was there before stays.
TEST_F(DeformationData, AFullDiskKeepsTheOldFiles) {
    write_image(noise_picture(300, 300, CV_8UC3), photo);
    const auto on_full_disk = [&](std::vector<std::string> arguments) {
        return puppetwarp_command(std::move(arguments), [] {
            const rlimit limit{20000, 20000};
            ::setrlimit(RLIMIT_FSIZE, &limit);
        });
    };
    for (const char* name : {"out.png", "out.tif", "out.exr", "out.webp", "out.jpg", "out.ppm"}) {
        put_bytes(folder / name, "what was there before");
        const CommandResult result = on_full_disk({"warp", photo, "--pin", "60,50", "-o", folder / name, "-q"});
        expect_refused(result, name, 3);
        EXPECT_EQ(bytes_of(folder / name), "what was there before") << name;
    }
    write_image(disc_picture(300, 300), disc);  // small as a PNG
    for (const char* name : {"map.exr", "map.tif"}) {
        put_bytes(folder / name, "what was there before");
        const CommandResult result = on_full_disk({"warp", disc, "--pin", "150,150@10", "--pin", "100,150:90,160", "-o",
                                                   out, "--displacement", folder / name});
        expect_refused(result, name, 3);
        EXPECT_EQ(bytes_of(folder / name), "what was there before") << name;
    }
    put_bytes(folder / "mesh.obj", "what was there before");
    expect_refused(on_full_disk({"warp", disc, "--pin", "150,150", "-o", out, "--mesh-out", folder / "mesh.obj"}),
                   "mesh.obj", 3);
    EXPECT_EQ(bytes_of(folder / "mesh.obj"), "what was there before");
    for (const auto& entry : fs::directory_iterator(folder.path()))
        EXPECT_THAT(entry.path().filename().string(), testing::Not(testing::StartsWith(".puppetwarp"))) << entry;
}

}  // namespace
}  // namespace puppetwarp::tests
