// What scripts rely on: exit codes, standard output, reports, whole files, the same bytes.

#include "pictures.h"
#include "support/run_command.h"

#include <puppetwarp/image/read.h>
#include <puppetwarp/image/write.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <csignal>
#include <cstring>

#include <unistd.h>

namespace puppetwarp::tests {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

class Contract : public testing::Test {
protected:
    CommandResult run(std::vector<std::string> arguments) const {
        const CommandResult result = puppetwarp_command(std::move(arguments));
        EXPECT_EQ(result.signal, 0);
        return result;
    }

    // True when both pictures have the same pixels where they are visible.
    static bool same_visible(const cv::Mat& a, const cv::Mat& b) {
        if (a.size() != b.size() || a.type() != b.type()) return false;
        const bool alpha = a.channels() % 2 == 0;
        for (int y = 0; y < a.rows; ++y) {
            for (int x = 0; x < a.cols; ++x) {
                const auto* p = a.ptr(y, x);
                const auto* q = b.ptr(y, x);
                const auto last = a.elemSize() - a.elemSize1();
                const unsigned char zero[8] = {};
                const bool invisible = alpha && std::memcmp(p + last, zero, a.elemSize1()) == 0 &&
                                       std::memcmp(q + last, zero, a.elemSize1()) == 0;
                if (!invisible && std::memcmp(p, q, a.elemSize()) != 0) return false;
            }
        }
        return true;
    }

    TemporaryFolder folder;
};

TEST_F(Contract, RestPoseGivesThePictureBack) {
    for (const int type : {CV_8UC1, CV_8UC2, CV_8UC3, CV_8UC4, CV_16UC1, CV_16UC2, CV_16UC3, CV_16UC4}) {
        for (const char* extension : {".png", ".tif"}) {
            const std::string in = folder / (std::string("in") + extension),
                              out = folder / (std::string("out") + extension);
            const Image picture = noise_picture(170, 130, type);
            write_image(picture, in);
            for (const char* method : {"arap", "harmonic", "biharmonic"}) {
                const CommandResult result = run({"warp", in, "--pin", "70,60", "--pin", "100,65", "--pin", "85,90",
                                                  "--method", method, "-o", out, "--quiet"});
                ASSERT_EQ(result.exit_code, 0) << result.errors;
                EXPECT_TRUE(same_visible(read_image(out).pixels, picture.pixels)) << type << extension << method;
            }
        }
    }
}

TEST_F(Contract, WholePixelMoveShiftsThePicture) {
    for (const int type : {CV_8UC4, CV_16UC2}) {
        const Image picture = noise_picture(170, 130, type);
        write_image(picture, folder / "in.png");
        const CommandResult result = run(
            {"warp", folder / "in.png", "--pin", "70,60:75,57", "--pin", "100,65:105,62", "-o", folder / "out.png"});
        ASSERT_EQ(result.exit_code, 0) << result.errors;
        const cv::Mat out = read_image(folder / "out.png").pixels;
        EXPECT_TRUE(same_visible(out(cv::Rect(5, 0, 165, 127)), picture.pixels(cv::Rect(0, 3, 165, 127)))) << type;
    }
}

TEST_F(Contract, WholePhotographMovesByWholePixels) {
    const Image picture = noise_picture(90, 70, CV_8UC3);
    write_image(picture, folder / "in.png");
    const CommandResult result = run({"warp", folder / "in.png", "--pin", "45,35:52,39", "-o", folder / "out.png"});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    const cv::Mat out = read_image(folder / "out.png").pixels;
    ASSERT_EQ(out.type(), CV_8UC4);  // what the picture left is uncovered
    for (int y = 0; y < 70; ++y) {
        for (int x = 0; x < 90; ++x) {
            const cv::Vec4b got = out.at<cv::Vec4b>(y, x);
            if (x < 7 || y < 4) {
                ASSERT_EQ(got[3], 0);
            } else {
                const cv::Vec3b wanted = picture.pixels.at<cv::Vec3b>(y - 4, x - 7);
                ASSERT_EQ(got, cv::Vec4b(wanted[0], wanted[1], wanted[2], 255)) << x << ' ' << y;
            }
        }
    }
}

TEST_F(Contract, PinsAreMet) {
    write_image(disc_picture(200, 200), folder / "in.png");
    for (const char* method : {"arap", "harmonic", "biharmonic"}) {
        const CommandResult result =
            run({"warp", folder / "in.png", "--pin", "70,100", "--pin", "130,100:136.25,90.5", "--pin",
                 "100,140:97,145", "--method", method, "-o", folder / "out.png", "--json"});
        ASSERT_EQ(result.exit_code, 0) << result.errors;
        const Json report = Json::parse(result.output);
        EXPECT_LT(report["max_handle_error_px"].get<double>(), 0.01) << method;
        EXPECT_TRUE(report["converged"].get<bool>()) << method;
        EXPECT_EQ(report["flipped_triangles"].get<int>(), 0) << method;
    }
}

TEST_F(Contract, ReportHasItsFields) {
    write_image(disc_picture(100, 100), folder / "in.png");
    const CommandResult result = run({"warp", folder / "in.png", "--pin", "40,50", "--pin", "60,50:65,45", "-o",
                                      folder / "out.png", "--json", "--report", folder / "report.json"});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    const Json report = Json::parse(result.output);
    EXPECT_EQ(Json::parse(bytes_of(folder / "report.json"))["energy"], report["energy"]);
    for (const char* key :
         {"method", "vertices", "triangles", "handles", "iterations", "converged", "energy", "energy_history",
          "flipped_triangles", "max_stretch", "max_area_ratio", "max_handle_error_px", "warnings", "canvas", "scale",
          "max_magnification", "lost", "timings_ms", "peak_memory_mb"}) {
        EXPECT_TRUE(report.contains(key)) << key;
    }
    for (const char* key : {"read", "cutout", "triangulate", "bind", "deform", "warp", "write"}) {
        EXPECT_TRUE(report["timings_ms"].contains(key)) << key;
    }
    EXPECT_EQ(report["method"], "arap");
    EXPECT_EQ(report["handles"], 2);
    EXPECT_EQ(report["energy_history"].back(), report["energy"]);
}

TEST_F(Contract, LargestMagnificationIsTold) {
    write_image(disc_picture(100, 100), folder / "in.png");
    const auto told = [&](const std::vector<std::string>& more) {
        std::vector<std::string> arguments{"-v",     "warp",   folder / "in.png", "-o", folder / "out.png",
                                           "--json", "--force"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        const CommandResult result = run(arguments);
        EXPECT_EQ(result.exit_code, 0) << result.errors;
        EXPECT_THAT(result.errors, testing::HasSubstr("magnified at most "));
        return Json::parse(result.output)["max_magnification"].get<double>();
    };
    EXPECT_NEAR(told({"--pin", "50,50"}), 1, 1e-6);
    EXPECT_NEAR(told({"--pin", "50,50", "--scale", "2.5"}), 2.5, 1e-5);
    const double pulled = told({"--pin", "30,50", "--pin", "70,50:90,50"});
    EXPECT_GT(pulled, 1.3);
    EXPECT_NEAR(told({"--pin", "30,50", "--pin", "70,50:90,50", "--scale", "0.5"}), pulled / 2, 1e-6);
}

TEST_F(Contract, WarpsInLinearLight) {
    // Black and white squares of a pixel, shrunk: half of the light, which is sRGB's 188.
    Image squares{cv::Mat(80, 80, CV_8UC3), {}};
    for (int i = 0; i < 80 * 80; ++i) {
        const int value = (i / 80 + i % 80) % 2 * 255;
        squares.pixels.at<cv::Vec3b>(i / 80, i % 80) = {
            static_cast<std::uint8_t>(value), static_cast<std::uint8_t>(value), static_cast<std::uint8_t>(value)};
    }
    write_image(squares, folder / "in.png");
    const auto middle = [&](const std::vector<std::string>& more) {
        std::vector<std::string> arguments{"warp", folder / "in.png", "--pin", "40,40", "--scale", "0.25",
                                           "-o",   folder / "out.png"};
        arguments.insert(arguments.end(), more.begin(), more.end());
        EXPECT_EQ(run(arguments).exit_code, 0);
        return static_cast<int>(read_image(folder / "out.png").pixels.at<cv::Vec3b>(10, 10)[1]);
    };
    EXPECT_NEAR(middle({}), 128, 1);
    EXPECT_NEAR(middle({"--linear"}), 188, 1);
    EXPECT_NEAR(middle({"--linear", "--interpolation", "lanczos3"}), 188, 1);
}

TEST_F(Contract, NotConvergingIsSaid) {
    write_image(disc_picture(200, 200), folder / "in.png");
    put_bytes(folder / "p.json", R"({"format": "puppetwarp", "version": 1, "image": "in.png",
        "handles": [{"id": "a", "type": "point", "at": [60, 100]}, {"id": "b", "type": "point", "at": [140, 100]}],
        "method": {"name": "arap", "max_iterations": 1},
        "poses": [{"name": "p", "handles": {"b": {"to": [120, 40]}}}]})");
    const CommandResult result = run({"warp", folder / "p.json", "-o", folder / "out.png", "--json"});
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_FALSE(Json::parse(result.output)["converged"].get<bool>());
    EXPECT_THAT(result.errors, testing::HasSubstr("did not converge"));
}

TEST_F(Contract, FoldGate) {
    write_image(disc_picture(200, 200), folder / "in.png");
    const std::vector<std::string> crossed = {"warp",  folder / "in.png", "--pin",    "85,100:150,100",
                                              "--pin", "115,100:50,100",  "--method", "harmonic",
                                              "--pin", "100,40",          "-o",       folder / "out.png"};
    EXPECT_EQ(run(crossed).exit_code, 0);
    std::vector<std::string> gated = crossed;
    gated.push_back("--fail-on-fold");
    EXPECT_EQ(run(gated).exit_code, 1);
    EXPECT_TRUE(fs::exists(folder / "out.png"));
    EXPECT_EQ(run({"warp", folder / "in.png", "--pin", "85,100", "-o", folder / "out.png", "--fail-on-fold"}).exit_code,
              0);
}

TEST_F(Contract, StretchGate) {
    write_image(disc_picture(200, 200), folder / "in.png");
    const std::vector<std::string> pulled = {"warp",  folder / "in.png",  "--pin",    "60,100:40,100",
                                             "--pin", "140,100:160,100",  "--method", "harmonic",
                                             "-o",    folder / "out.png", "--json"};
    const CommandResult result = run(pulled);
    const double stretch = Json::parse(result.output)["max_stretch"].get<double>();
    ASSERT_GT(stretch, 1.2);
    const auto gated = [&](const std::string& most) {
        std::vector<std::string> arguments = pulled;
        arguments.insert(arguments.end(), {"--fail-on-stretch", most});
        return run(arguments).exit_code;
    };
    EXPECT_EQ(gated(std::to_string(stretch - 0.01)), 1);
    EXPECT_EQ(gated(std::to_string(stretch + 0.01)), 0);
    EXPECT_EQ(gated("0.99"), 2);
    EXPECT_EQ(gated("nan"), 2);
}

TEST_F(Contract, APartWithoutAHandleStaysAndIsWarnedOf) {
    Image two = disc_picture(120, 120);
    two.pixels(cv::Rect(0, 55, 120, 10)).setTo(cv::Scalar::all(0));
    write_image(two, folder / "in.png");
    const std::vector<std::string> arguments = {"warp", folder / "in.png",  "--pin", "60,40:64,40",
                                                "-o",   folder / "out.png", "--json"};
    const CommandResult result = run(arguments);
    ASSERT_EQ(result.exit_code, 0);
    EXPECT_THAT(result.errors,
                testing::AllOf(testing::StartsWith("puppetwarp: warning: "), testing::HasSubstr("no handle")));
    EXPECT_EQ(std::count(result.errors.begin(), result.errors.end(), '\n'), 1);
    EXPECT_EQ(Json::parse(result.output)["warnings"].size(), 1u);
    const cv::Mat out = read_image(folder / "out.png").pixels;
    const cv::Rect lower(0, 70, 120, 50);
    EXPECT_TRUE(same_visible(out(lower), two.pixels(lower)));
    std::vector<std::string> quiet = arguments;
    quiet.push_back("-q");
    EXPECT_EQ(run(quiet).errors, "");
}

TEST_F(Contract, BonesRegionsAndStiffnessPicturesInAPuppetFile) {
    write_image(disc_picture(200, 200), folder / "in.png");
    write_image(noise_picture(50, 50, CV_8UC3), folder / "stiff.png");
    put_bytes(folder / "p.json", R"({"format": "puppetwarp", "version": 1, "image": "in.png",
        "handles": [{"id": "arm", "type": "bone", "from": [100, 100], "to": [150, 100]},
                    {"id": "hand", "type": "bone", "from": [150, 100], "to": [170, 100], "parent": "arm"},
                    {"id": "spot", "type": "region", "points": [[40, 80], [70, 80], [70, 120], [40, 120]]}],
        "stiffness": [{"image": "stiff.png", "max": 20}],
        "poses": [{"name": "p", "handles": {"arm": {"rotate_deg": 10}, "spot": {"to": [57, 98], "rotate_deg": 5}}}]})");
    const CommandResult result = run({"warp", folder / "p.json", "-o", folder / "out.png", "--json"});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_EQ(Json::parse(result.output)["handles"], 3);
    EXPECT_LT(Json::parse(result.output)["max_handle_error_px"].get<double>(), 0.01);
    EXPECT_EQ(run({"info", folder / "p.json"}).exit_code, 0);
    EXPECT_EQ(run({"warp", folder / "p.json", "-o", folder / "stiff.png"}).exit_code, 2);  // an input
    put_bytes(folder / "stiff.png", "no picture");
    EXPECT_EQ(run({"warp", folder / "p.json", "-o", folder / "out.png"}).exit_code, 2);
}

TEST_F(Contract, SameBytesForAnyNumberOfThreads) {
    write_image(noise_picture(400, 300, CV_8UC4), folder / "in.png");
    std::string first;
    for (const char* threads : {"1", "2", "7"}) {
        const CommandResult result = run({"warp", folder / "in.png", "--pin", "160,150", "--pin", "240,150:260,110",
                                          "--pin", "200,200:190,220", "-j", threads, "-o", folder / "out.png"});
        ASSERT_EQ(result.exit_code, 0) << result.errors;
        const std::string bytes = bytes_of(folder / "out.png");
        if (first.empty()) first = bytes;
        EXPECT_TRUE(bytes == first) << threads;
    }
}

TEST_F(Contract, JpegKeepsWhatIsBehindAndSaysWhatIsLost) {
    write_image(noise_picture(90, 70, CV_8UC3), folder / "in.png");
    const std::vector<std::string> arguments = {"warp", folder / "in.png", "--pin", "45,35:52,39",
                                                "-o",   folder / "out.jpg"};
    const CommandResult result = run(arguments);
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_THAT(result.errors, testing::HasSubstr("alpha"));
    EXPECT_EQ(read_image(folder / "out.jpg").pixels.channels(), 3);
    std::vector<std::string> strict = arguments;
    strict.push_back("--strict");
    fs::remove(folder / "out.jpg");
    EXPECT_EQ(run(strict).exit_code, 2);
    EXPECT_FALSE(fs::exists(folder / "out.jpg"));
}

TEST_F(Contract, Diff) {
    Image picture = noise_picture(60, 40, CV_8UC3);
    write_image(picture, folder / "a.png");
    Image deeper;
    picture.pixels.convertTo(deeper.pixels, CV_16U, 257);
    write_image(deeper, folder / "a16.png");
    picture.pixels.at<cv::Vec3b>(7, 30)[1] ^= 4;
    write_image(picture, folder / "b.png");
    write_image(noise_picture(61, 40, CV_8UC3), folder / "wider.png");

    EXPECT_EQ(run({"diff", folder / "a.png", folder / "a.png"}).exit_code, 0);
    EXPECT_EQ(run({"diff", folder / "a.png", folder / "a16.png"}).exit_code, 0);
    EXPECT_EQ(run({"diff", folder / "a.png", folder / "wider.png"}).exit_code, 1);
    EXPECT_EQ(run({"diff", folder / "a.png", folder / "b.png", "--threshold", "4/255"}).exit_code, 0);
    EXPECT_EQ(run({"diff", folder / "a.png", folder / "b.png", "--threshold", "3.9/255"}).exit_code, 1);
    const CommandResult result =
        run({"diff", folder / "a.png", folder / "b.png", "--heatmap", folder / "map.png", "--json"});
    EXPECT_EQ(result.exit_code, 1);
    const Json report = Json::parse(result.output);
    EXPECT_EQ(report["differing_pixels"], 1);
    EXPECT_EQ(report["max_at"], Json({30, 7}));
    EXPECT_NEAR(report["max"].get<double>(), 4.0 / 255, 1e-12);
    EXPECT_EQ(read_image(folder / "map.png").width(), 60);
}

TEST_F(Contract, HelpAndVersionEverywhere) {
    EXPECT_EQ(run({"--version"}).output, "puppetwarp 0.1.0\n");
    for (const std::string command : {"warp", "mesh", "deform", "diff", "info", "schema", "completion", "man"}) {
        const CommandResult help = run({command, "--help"});
        EXPECT_EQ(help.exit_code, 0);
        EXPECT_THAT(help.output, testing::HasSubstr("Example:"));
        EXPECT_THAT(help.output, testing::HasSubstr("puppetwarp " + command));
    }
}

TEST_F(Contract, MeshAndDeformGoTogether) {
    write_image(disc_picture(100, 100), folder / "in.png");
    ASSERT_EQ(run({"mesh", folder / "in.png", "-o", folder / "m.off", "--max-edge-px", "10"}).exit_code, 0);
    put_bytes(folder / "rig.json", R"({"format": "puppetwarp", "version": 1,
        "handles": [{"id": "a", "type": "vertex", "index": 0}, {"id": "b", "type": "vertex", "index": 5}],
        "poses": [{"name": "p", "handles": {"a": {"to": [1.25, 2.5]}}}]})");
    const CommandResult result = run(
        {"deform", folder / "m.off", "--rig", folder / "rig.json", "--method", "harmonic", "-o", folder / "moved.csv"});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    const std::string csv = bytes_of(folder / "moved.csv");
    EXPECT_THAT(csv, testing::StartsWith("x,y\n1.25,2.5\n"));
    const CommandResult info = run({"info", folder / "m.off", "--json"});
    EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n') - 1, Json::parse(info.output)["vertices"].get<int>());
}

TEST_F(Contract, SymbolicLinksAndPermissionsStay) {
    write_image(disc_picture(60, 60), folder / "in.png");
    put_bytes(folder / "real.png", "old");
    fs::permissions(folder / "real.png", fs::perms::owner_read | fs::perms::owner_write | fs::perms::group_read);
    fs::create_symlink("real.png", folder / "link.png");
    ASSERT_EQ(run({"warp", folder / "in.png", "--pin", "30,30", "-o", folder / "link.png"}).exit_code, 0);
    EXPECT_TRUE(fs::is_symlink(folder / "link.png"));
    EXPECT_EQ(read_image(folder / "real.png").width(), 60);
    EXPECT_EQ(fs::status(folder / "real.png").permissions(),
              fs::perms::owner_read | fs::perms::owner_write | fs::perms::group_read);
}

TEST_F(Contract, StandardOutputTakesThePicture) {
    write_image(disc_picture(60, 60), folder / "in.png");
    ASSERT_EQ(run({"warp", folder / "in.png", "--pin", "30,30", "-o", folder / "out.png"}).exit_code, 0);
    const std::string wanted = bytes_of(folder / "out.png");
    EXPECT_EQ(run({"warp", folder / "in.png", "--pin", "30,30", "-o", "-"}).output, wanted);
    EXPECT_EQ(run({"warp", folder / "in.png", "--pin", "30,30", "-o", "/dev/stdout"}).output, wanted);
    EXPECT_TRUE(fs::exists("/dev/stdout"));
}

}  // namespace
}  // namespace puppetwarp::tests
