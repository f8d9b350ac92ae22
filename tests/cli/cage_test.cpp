// Cages through the command: found by themselves, kept in puppet files, moved in poses, and refused when they cannot
// be.

#include "pictures.h"
#include "support/run_command.h"

#include <puppetwarp/image/read.h>
#include <puppetwarp/image/write.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace puppetwarp::tests {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using testing::HasSubstr;

const std::vector<std::string> kinds{"shepard",   "harmonic",   "biharmonic",    "bbw",   "l1",
                                     "monotonic", "mean-value", "harmonic-cage", "green", "cauchy"};

class Cage : public testing::Test {
protected:
    Cage() {
        write_image(disc_picture(120, 100), picture);
        put_bytes(coarse, R"({"format": "puppetwarp", "version": 1, "image": "in.png", "mesh": {"max_edge_px": 12},
            "method": {"name": "lbs", "weights": "mean-value"}})");
    }

    CommandResult run(std::vector<std::string> arguments) const {
        const CommandResult result = puppetwarp_command(std::move(arguments));
        EXPECT_EQ(result.signal, 0);
        return result;
    }

    static void expect_refused(const CommandResult& result, const std::string& mentions) {
        EXPECT_EQ(result.exit_code, 2) << result.errors;
        EXPECT_THAT(result.errors, testing::StartsWith("puppetwarp: "));
        EXPECT_EQ(std::count(result.errors.begin(), result.errors.end(), '\n'), 1) << result.errors;
        EXPECT_THAT(result.errors, HasSubstr(mentions));
    }

    // A puppet file with an automatic cage, moved in its pose `p` as the function says.
    std::string posed(int corners, const std::function<Json(double x, double y)>& target) const {
        EXPECT_EQ(run({"warp", coarse, "--auto-cage", std::to_string(corners), "--save-puppet",
                       folder / "saved.puppet.json", "-o", out})
                      .exit_code,
                  0);
        Json puppet = Json::parse(bytes_of(folder / "saved.puppet.json"));
        Json to = Json::array();
        for (const Json& p : puppet["handles"][0]["points"]) to.push_back(target(p[0], p[1]));
        puppet["poses"] = {{{"name", "p"}, {"handles", {{"cage", {{"to", to}}}}}}};
        put_bytes(folder / "posed.puppet.json", puppet.dump());
        return folder / "posed.puppet.json";
    }

    // Warps the picture through cages with these points.
    CommandResult through(const std::vector<std::string>& cages, const std::string& kind,
                          const std::string& method = "lbs") const {
        std::string handles;
        for (std::size_t k = 0; k < cages.size(); ++k) {
            handles += std::string(k > 0 ? "," : "") + R"({"id": "c)" + std::to_string(k) +
                       R"(", "type": "cage", "points": )" + cages[k] + "}";
        }
        put_bytes(folder / "cages.puppet.json", R"({"format": "puppetwarp", "version": 1, "image": "in.png",
            "mesh": {"max_edge_px": 12}, "handles": [)" +
                                                    handles + "]}");
        return run(
            {"warp", folder / "cages.puppet.json", "--method", method, "--weights", kind, "-o", out, "--no-cache"});
    }

    TemporaryFolder folder;
    std::string picture = folder / "in.png";
    std::string coarse = folder / "coarse.puppet.json";  // the same, of few triangles
    std::string out = folder / "out.png";
};

TEST_F(Cage, OfItsOwnGoesAroundTheSubjectAndIntoAPuppetFile) {
    const CommandResult result = run({"warp", picture, "--auto-cage", "7", "--method", "lbs", "--weights", "mean-value",
                                      "--save-puppet", folder / "p.puppet.json", "-o", out, "--json"});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_EQ(Json::parse(result.output)["handles"], 1);
    const Json puppet = Json::parse(bytes_of(folder / "p.puppet.json"));
    EXPECT_EQ(puppet["image"], "in.png");
    EXPECT_EQ(puppet["method"]["name"], "lbs");
    EXPECT_EQ(puppet["method"]["weights"], "mean-value");
    ASSERT_EQ(puppet["handles"].size(), 1U);
    const Json& cage = puppet["handles"][0];
    EXPECT_EQ(cage["id"], "cage");
    EXPECT_EQ(cage["type"], "cage");
    ASSERT_EQ(cage["points"].size(), 7U);
    for (std::size_t k = 0; k < 7; ++k) {
        const Json &a = cage["points"][k], &b = cage["points"][(k + 1) % 7];
        // Edges pass the disc, of radius 40 about (60, 50), by its expansion and the margin, and not far from it.
        const double ax = a[0].get<double>() - 60, ay = a[1].get<double>() - 50;
        const double bx = b[0].get<double>() - 60, by = b[1].get<double>() - 50;
        const double distance = (ax * by - ay * bx) / std::hypot(bx - ax, by - ay);
        EXPECT_GT(distance, 40 + 2);
        EXPECT_LT(distance, 40 + 2 + 3);
    }
}

TEST_F(Cage, AtRestGivesThePictureBack) {
    for (const std::string& kind : kinds) {
        const CommandResult result =
            run({"warp", coarse, "--auto-cage", "5", "--weights", kind, "--no-cache", "-o", out});
        ASSERT_EQ(result.exit_code, 0) << result.errors;
        const cv::Mat still = read_image(picture).pixels, found = read_image(out).pixels;
        for (int y = 0; y < still.rows; ++y) {
            for (int x = 0; x < still.cols; ++x) {
                const cv::Vec4b a = still.at<cv::Vec4b>(y, x), b = found.at<cv::Vec4b>(y, x);
                ASSERT_TRUE(a == b || (a[3] == 0 && b[3] == 0)) << kind << ' ' << x << ' ' << y;
            }
        }
    }
}

TEST_F(Cage, WarpsThroughWeightsOfEveryKind) {
    const std::string puppet = posed(8, [](double x, double y) { return Json{x + 0.1 * y, y - 0.05 * x}; });
    for (const std::string& kind : kinds) {
        for (const char* method : {"lbs", "dual-complex", "intrinsic"}) {
            if ((kind == "green" || kind == "cauchy") && std::string(method) != "lbs") continue;
            const CommandResult result =
                run({"warp", puppet, "--method", method, "--weights", kind, "--no-cache", "-o", out, "--json"});
            ASSERT_EQ(result.exit_code, 0) << kind << ' ' << result.errors;
            const Json report = Json::parse(result.output);
            EXPECT_EQ(report["flipped_triangles"], 0) << kind;
            EXPECT_EQ(run({"diff", picture, out}).exit_code, 1) << kind;
        }
    }
}

TEST_F(Cage, CarriesThePictureAlong) {
    const std::string puppet = posed(9, [](double x, double y) { return Json{x + 8, y - 3}; });
    for (const std::string& kind : kinds) {
        ASSERT_EQ(run({"warp", puppet, "--weights", kind, "--no-cache", "-o", out}).exit_code, 0);
        const cv::Mat moved = read_image(out).pixels, still = read_image(picture).pixels;
        const cv::Rect to(8, 0, 112, 97), from(0, 3, 112, 97);
        int worst = 0;
        for (int y = 0; y < to.height; ++y) {
            for (int x = 0; x < to.width; ++x) {
                const int a = moved(to).at<cv::Vec4b>(y, x)[3], b = still(from).at<cv::Vec4b>(y, x)[3];
                worst = std::max(worst, std::abs(a - b));
            }
        }
        EXPECT_LE(worst, 1) << kind;
    }
}

TEST_F(Cage, GoesWithPinsAndASavedPuppetGivesTheSamePicture) {
    const std::string saved = folder / "s.puppet.json";
    const CommandResult result =
        run({"warp", picture, "--auto-cage", "6", "--pin", "60,50:66,47@10", "--pin", "40,50", "--method", "lbs",
             "--weights", "harmonic-cage", "--save-puppet", saved, "-o", out, "--json"});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_EQ(Json::parse(result.output)["handles"], 3);
    const Json puppet = Json::parse(bytes_of(saved));
    EXPECT_EQ(puppet["handles"][0]["id"], "pin1");
    EXPECT_EQ(puppet["handles"][2]["id"], "cage");
    EXPECT_EQ(puppet["poses"][0]["name"], "pins");
    ASSERT_EQ(run({"warp", saved, "-o", folder / "again.png"}).exit_code, 0);
    EXPECT_TRUE(bytes_of(folder / "again.png") == bytes_of(out));
    EXPECT_EQ(run({"info", saved}).exit_code, 0);
}

TEST_F(Cage, OfItsOwnIsTheSameBytesForAnyNumberOfThreads) {
    std::string first;
    for (const char* threads : {"1", "2", "7"}) {
        ASSERT_EQ(run({"warp", picture, "--auto-cage", "11", "--method", "lbs", "--weights", "harmonic-cage", "-j",
                       threads, "--save-puppet", folder / "p.puppet.json", "-o", out})
                      .exit_code,
                  0);
        const std::string bytes = bytes_of(folder / "p.puppet.json") + bytes_of(out);
        if (first.empty()) first = bytes;
        EXPECT_TRUE(bytes == first) << threads;
    }
}

TEST_F(Cage, IsWeighedCornerByCorner) {
    for (const std::vector<std::string>& input :
         {std::vector<std::string>{picture}, std::vector<std::string>{folder / "m.off"}}) {
        ASSERT_EQ(run({"mesh", picture, "-o", folder / "m.off", "--force"}).exit_code, 0);
        const CommandResult result = run({"weights", input[0], "--auto-cage", "4", "--kind", "mean-value", "-o",
                                          folder / "w.csv", "--json", "--save-puppet", folder / "w.puppet.json"});
        ASSERT_EQ(result.exit_code, 0) << result.errors;
        EXPECT_EQ(Json::parse(result.output)["columns"], 4);
        EXPECT_THAT(bytes_of(folder / "w.csv"), testing::StartsWith("cage[0],cage[1],cage[2],cage[3]\n"));
        EXPECT_EQ(Json::parse(bytes_of(folder / "w.puppet.json"))["handles"][0]["points"].size(), 4U);
    }
}

TEST_F(Cage, DeformsAMesh) {
    put_bytes(folder / "m.off", "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n");
    put_bytes(folder / "rig.json", R"({"format": "puppetwarp", "version": 1})");
    ASSERT_EQ(run({"deform", folder / "m.off", "--rig", folder / "rig.json", "--auto-cage", "4", "--method", "lbs",
                   "--weights", "cauchy", "--save-puppet", folder / "p.json", "-o", folder / "rest.csv"})
                  .exit_code,
              0);
    Json puppet = Json::parse(bytes_of(folder / "p.json"));
    Json to = Json::array();
    for (const Json& p : puppet["handles"][0]["points"]) {
        to.push_back({2 * p[0].get<double>() + 3, 2 * p[1].get<double>() - 1});
    }
    puppet["poses"] = {{{"name", "p"}, {"handles", {{"cage", {{"to", to}}}}}}};
    puppet["method"] = {{"name", "lbs"}, {"weights", "cauchy"}};
    put_bytes(folder / "p.json", puppet.dump());
    const CommandResult result = run({"deform", folder / "m.off", "--rig", folder / "p.json", "-o", "-"});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    std::istringstream lines(result.output);
    std::string header;
    std::getline(lines, header);
    for (const auto& [x, y] : {std::pair(3.0, -1.0), {5.0, -1.0}, {5.0, 1.0}, {3.0, 1.0}}) {
        double found_x = 0, found_y = 0;
        char comma = 0;
        ASSERT_TRUE(lines >> found_x >> comma >> found_y);
        EXPECT_NEAR(found_x, x, 1e-12);
        EXPECT_NEAR(found_y, y, 1e-12);
    }
}

TEST_F(Cage, NumbersOfCornersOutOfRangeAreRefused) {
    for (const char* corners : {"2", "0", "-3", "501", "many", "4.5", ""}) {
        for (const char* command : {"warp", "weights"}) {
            expect_refused(run({command, picture, "--auto-cage", corners, "-o", out}), "--auto-cage");
        }
    }
    EXPECT_FALSE(fs::exists(out));
    for (const char* corners : {"3", "500"}) {
        EXPECT_EQ(
            run({"warp", picture, "--auto-cage", corners, "--method", "lbs", "--weights", "harmonic-cage", "-o", out})
                .exit_code,
            0);
    }
}

TEST_F(Cage, WhatItDoesNotGoWithIsRefused) {
    expect_refused(run({"warp", picture, "--auto-cage", "6", "-o", out}), "a cage cannot drive 'arap'");
    const std::string puppet = posed(6, [](double x, double y) { return Json{x, y}; });
    expect_refused(run({"warp", puppet, "--auto-cage", "6", "-o", out}), "there is the cage 'cage' already");
    expect_refused(run({"warp", picture, "--auto-cage", "6", "--pin", "60,50", "--method", "lbs", "--weights", "cauchy",
                        "-o", out}),
                   "formula of one cage");
    expect_refused(run({"weights", folder / "none.off", "--kind", "mean-value", "-o", folder / "w.csv"}),
                   "--auto-cage");
}

TEST_F(Cage, SavedPuppetsReplaceNothingUnasked) {
    const std::string puppet = posed(6, [](double x, double y) { return Json{x, y}; });
    const std::string before = bytes_of(puppet);
    expect_refused(run({"warp", puppet, "--save-puppet", puppet, "-o", out}), "is the input itself");
    EXPECT_EQ(bytes_of(puppet), before);
    expect_refused(run({"warp", puppet, "--save-puppet", out, "-o", out}), "named for two results");
    EXPECT_EQ(run({"warp", puppet, "--save-puppet", puppet, "-o", out, "--force"}).exit_code, 0);
}

TEST_F(Cage, ThatCannotBeIsRefused) {
    const std::string around = "[[0, 0], [120, 0], [120, 100], [0, 100]]";
    for (const std::string& kind : {std::string("mean-value"), std::string("cauchy"), std::string("harmonic-cage"),
                                    std::string("bbw"), std::string("shepard")}) {
        expect_refused(through({"[[0, 0], [120, 100], [120, 0], [0, 100]]"}, kind), "crosses or touches itself");
        expect_refused(through({"[[0, 0], [120, 0], [120, 100], [60, 0], [0, 100]]"}, kind),
                       "crosses or touches itself");
        expect_refused(through({"[[200, 0], [240, 0], [240, 90]]"}, kind), "leaves the subject outside");
        expect_refused(through({"[[0, 0], [10, 0], [20, 0]]"}, kind), "no area");
        expect_refused(through({"[[0, 0], [120, 0], [120, 0], [120, 100], [0, 100]]"}, kind), "in one place");
        EXPECT_EQ(through({around}, kind).exit_code, 0);
    }
    expect_refused(through({"[[0, 0], [120, 100]]"}, "bbw"), "at least 3 points");
    expect_refused(through({around, "[[5, 5], [130, 5], [130, 90]]"}, "harmonic-cage"), "'c0' and 'c1'");
    expect_refused(through({around, "[[200, 0], [240, 0], [240, 90]]"}, "harmonic"), "handle 'c1'");
    expect_refused(
        through({"[[0, 0], [58, 0], [58, 100], [0, 100]]", "[[62, 0], [120, 0], [120, 100], [62, 100]]"}, "mean-value"),
        "more handles than that");
    expect_refused(through({around}, "bbw", "biharmonic"), "use the method lbs");
    EXPECT_FALSE(fs::exists(folder / "cages.puppet.weights"));
}

TEST_F(Cage, SeveralAndPartialCagesWork) {
    const std::string left = "[[0, 0], [58, 0], [58, 100], [0, 100]]",
                      right = "[[62, 0], [120, 0], [120, 100], [62, 100]]";
    for (const char* kind : {"harmonic", "harmonic-cage", "biharmonic", "bbw", "monotonic", "l1", "shepard"}) {
        EXPECT_EQ(through({left, right}, kind).exit_code, 0) << kind;
        EXPECT_EQ(
            through({"[[-5, -5], [125, -5], [125, 105], [-5, 105]]", "[[50, 40], [70, 40], [70, 60], [50, 60]]"}, kind)
                .exit_code,
            0)
            << kind;
        EXPECT_EQ(through({left}, kind).exit_code, 0) << kind;
    }
    EXPECT_EQ(through({left}, "mean-value").exit_code, 0);
    const CommandResult partial = through({left}, "cauchy");
    EXPECT_EQ(partial.exit_code, 0);
    EXPECT_THAT(partial.errors, HasSubstr("vertices lie outside the cage 'c0'"));
}

TEST_F(Cage, OfHundredsOfCornersWorks) {
    std::string circle;
    for (int k = 0; k < 500; ++k) {
        const double angle = 2 * 3.14159265358979 * k / 500;
        circle += (k > 0 ? ",[" : "[") + std::to_string(60 + 55 * std::cos(angle)) + "," +
                  std::to_string(50 + 55 * std::sin(angle)) + "]";
    }
    for (const char* kind : {"mean-value", "cauchy", "harmonic", "harmonic-cage", "biharmonic", "shepard"}) {
        EXPECT_EQ(through({"[" + circle + "]"}, kind).exit_code, 0) << kind;
    }
}

}  // namespace
}  // namespace puppetwarp::tests
