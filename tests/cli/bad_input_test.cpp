// Everything wrong that a person can give the command: one line on standard error, exit code 2 (or 3 for the machine),
// no output file, nothing lost.

#include "pictures.h"
#include "support/run_command.h"

#include <puppetwarp/image/write.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>

#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

namespace puppetwarp::tests {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class BadInput : public testing::Test {
protected:
    BadInput() {
        write_image(disc_picture(120, 100), good);
        write_image(noise_picture(80, 60, CV_8UC3), photo);
    }

    // The one line of DESIGN.md section 4: `puppetwarp: WHAT: why (what to do)`.
    static void expect_refused(const CommandResult& result, const std::string& mentions, int exit_code = 2) {
        EXPECT_EQ(result.exit_code, exit_code) << result.errors;
        EXPECT_THAT(result.errors, testing::StartsWith("puppetwarp: "));
        EXPECT_EQ(std::count(result.errors.begin(), result.errors.end(), '\n'), 1) << result.errors;
        EXPECT_THAT(result.errors, HasSubstr(mentions));
        EXPECT_EQ(result.output, "");
    }

    CommandResult warp(const std::string& input, std::vector<std::string> more = {"--pin", "60,50"}) const {
        more.insert(more.begin(), {"warp", input, "-o", out});
        return puppetwarp_command(more);
    }

    // Warps a puppet file with this text.
    CommandResult warp_puppet(const std::string& json) const {
        put_bytes(folder / "test.puppet.json", json);
        return warp(folder / "test.puppet.json", {});
    }

    TemporaryFolder folder;
    std::string good = folder / "good.png";
    std::string photo = folder / "photo.png";
    std::string out = folder / "out.png";
};

TEST_F(BadInput, TheGoodCaseWorks) {
    const CommandResult result = warp(good);
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_TRUE(fs::exists(out));
}

TEST_F(BadInput, PathsThatAreNoFile) {
    expect_refused(warp(folder / "missing.png"), "missing.png: no such file");
    expect_refused(warp(folder.path().string()), "is a folder");
    put_bytes(folder / "empty.png", "");
    expect_refused(warp(folder / "empty.png"), "empty");
    ASSERT_EQ(::mkfifo((folder / "pipe.png").c_str(), 0600), 0);
    expect_refused(warp(folder / "pipe.png"), "not a regular file");
    EXPECT_FALSE(fs::exists(out));
}

TEST_F(BadInput, FilesThatAreNoWholePicture) {
    put_bytes(folder / "text.png", "This is not a picture at all, only words.\n");
    expect_refused(warp(folder / "text.png"), "text.png");
    write_image(noise_picture(200, 200, CV_8UC3), folder / "whole.png");
    const std::string png = bytes_of(folder / "whole.png");
    put_bytes(folder / "cut.png", png.substr(0, png.size() / 2));
    expect_refused(warp(folder / "cut.png"), "cut.png");
    write_image(noise_picture(200, 200, CV_8UC3), folder / "whole.jpg");
    const std::string jpeg = bytes_of(folder / "whole.jpg");
    put_bytes(folder / "cut.jpg", jpeg.substr(0, jpeg.size() / 2));
    expect_refused(warp(folder / "cut.jpg"), "cut.jpg");
    EXPECT_FALSE(fs::exists(out));
}

TEST_F(BadInput, PicturesThatCannotBeWorkedWith) {
    expect_refused(warp(good, {"--pin", "60,50", "--max-pixels", "1000"}), "--max-pixels");
    Image transparent = disc_picture(50, 50);
    transparent.pixels.setTo(cv::Scalar(0));
    write_image(transparent, folder / "transparent.png");
    expect_refused(warp(folder / "transparent.png", {"--pin", "25,25"}), "transparent");
}

TEST_F(BadInput, PicturesTooSmallToBeWarped) {
    for (const int size : {1, 3}) {
        write_image(noise_picture(size, size, CV_8UC3), folder / "tiny.png");
        expect_refused(warp(folder / "tiny.png", {"--pin", "0.5,0.5"}), "too small");
    }
    write_image(noise_picture(4, 4, CV_8UC3), folder / "small.png");
    EXPECT_EQ(warp(folder / "small.png", {"--pin", "2,2"}).exit_code, 0);
}

TEST_F(BadInput, PinsFarAway) {
    expect_refused(warp(good, {"--pin", "1e308,1e308"}), "outside");
    expect_refused(warp(good, {"--pin", "1e200,50"}), "outside");
    for (const char* pin : {"60,50:1e308,1e308", "60,50:1e10,1e10", "60,50:0,-1e155"}) {
        for (const char* method : {"arap", "harmonic", "biharmonic"}) {
            expect_refused(warp(good, {"--pin", pin, "--pin", "70,60", "--method", method}), "far");
        }
    }
}

TEST_F(BadInput, PinsAlmostInOnePlaceThatContradict) {
    expect_refused(warp(good, {"--pin", "60,50", "--pin", "60,50.001:70,50"}), "pin2");
}

TEST_F(BadInput, PinsOutsideTheSubject) {
    const CommandResult result = warp(good, {"--pin", "2,50"});
    expect_refused(result, "--pin-snap");
    EXPECT_THAT(result.errors, testing::ContainsRegex("[0-9.]+ px"));
    EXPECT_EQ(warp(good, {"--pin", "2,50", "--pin-snap", "60"}).exit_code, 0);
    expect_refused(warp(good, {"--pin", "2,50", "--pin-snap", "3"}), "--pin-snap");
}

TEST_F(BadInput, PinsThatContradict) {
    expect_refused(warp(good, {"--pin", "60,50:70,50", "--pin", "60,50:50,50"}), "pin2");
    EXPECT_EQ(warp(good, {"--pin", "60,50:65,50", "--pin", "60,50:65,50"}).exit_code, 0);
}

TEST_F(BadInput, PinsThatAreNoNumbers) {
    for (const char* pin :
         {"nan,50", "60,inf", "60,50:nan,1", "1e999,50", "60", "60,50:70", "a,b", "60,50@x", "", "60,50,70"}) {
        expect_refused(warp(good, {"--pin", pin}), "--pin");
    }
}

TEST_F(BadInput, NothingToDo) {
    expect_refused(warp(good, {}), "no pins");
    expect_refused(puppetwarp_command({}), "usage");
    expect_refused(puppetwarp_command({"dance"}), "usage");
    expect_refused(puppetwarp_command({"warp"}), "usage");
    expect_refused(warp(good, {"--pin", "60,50", "--nonsense"}), "--nonsense");
}

TEST_F(BadInput, UnknownNames) {
    expect_refused(warp(good, {"--pin", "60,50", "--method", "magic"}), "magic");
    expect_refused(warp(good, {"--pin", "60,50", "--arap-energy", "magic"}), "magic");
    expect_refused(warp(good, {"--pin", "60,50", "--interpolation", "magic"}), "magic");
    expect_refused(warp(good, {"--pin", "60,50", "--background", "magic"}), "magic");
    expect_refused(warp(good, {"--pin", "60,50", "--back-faces", "magic"}), "magic");
    expect_refused(warp(good, {"--pin", "60,50", "--canvas", "magic"}), "magic");
    expect_refused(warp(good, {"--pin", "60,50", "--pose", "magic"}), "magic");
}

TEST_F(BadInput, MeshOptionsOutOfRange) {
    expect_refused(puppetwarp_command({"mesh", good, "-o", folder / "m.off", "--min-angle-deg", "31"}), "0 to 30");
    expect_refused(puppetwarp_command({"mesh", good, "-o", folder / "m.off", "--max-edge-px", "0"}), "max-edge-px");
    expect_refused(puppetwarp_command({"mesh", good, "-o", folder / "m.off", "--max-edge-px", "0.0001"}), "vert");
    expect_refused(puppetwarp_command({"mesh", good, "-o", folder / "m.stl"}), ".off");
}

TEST_F(BadInput, PuppetFilesThatAreNone) {
    expect_refused(warp_puppet("not json"), "JSON");
    expect_refused(warp_puppet("{\"format\": \"puppetwarp\", "), "line 1");
    expect_refused(warp_puppet("[]"), "object");
    expect_refused(warp_puppet(R"({"version": 1})"), "format");
    expect_refused(warp_puppet(R"({"format": "other", "version": 1})"), "format");
    expect_refused(warp_puppet(R"({"format": "puppetwarp", "version": 2})"), "version");
    expect_refused(warp_puppet(std::string(100000, '[')), "");
}

TEST_F(BadInput, PuppetFieldsOfTheWrongTypeAreNamed) {
    const std::string head = R"({"format": "puppetwarp", "version": 1, "image": "good.png", )";
    const auto point = [&](const std::string& rest) {
        return head + R"("handles": [{"id": "a", "type": "point", "at": [60, 50]}], )" + rest + "}";
    };
    expect_refused(warp_puppet(head + R"("handles": 7})"), "handles");
    expect_refused(warp_puppet(head + R"("handles": [{"id": "a", "type": "point", "at": "here"}]})"), "handles[0].at");
    expect_refused(warp_puppet(head + R"("handles": [{"id": "a", "type": "point", "at": [1, 2, 3]}]})"),
                   "handles[0].at");
    expect_refused(warp_puppet(head + R"("handles": [{"id": 7, "type": "point", "at": [1, 2]}]})"), "handles[0].id");
    expect_refused(warp_puppet(head + R"("handles": [{"id": "a", "type": "blob", "at": [1, 2]}]})"), "handles[0].type");
    expect_refused(warp_puppet(point(R"("mesh": {"min_angle_deg": 40})")), "mesh.min_angle_deg");
    expect_refused(warp_puppet(point(R"("mesh": {"max_edge_px": "fine"})")), "mesh.max_edge_px");
    expect_refused(warp_puppet(point(R"("method": {"name": "magic"})")), "method.name");
    expect_refused(warp_puppet(point(R"("poses": [{"name": "p", "handles": {"b": {"to": [1, 2]}}}])")),
                   "poses[0].handles.b");
    expect_refused(warp_puppet(point(R"("poses": [{"name": "p", "handles": {"a": {"to": [1, 1e999]}}}])")), "");
    expect_refused(warp_puppet(point(R"("poses": [{"name": "p", "handles": {"a": {"to": [1, null]}}}])")),
                   "poses[0].handles.a.to");
    expect_refused(warp_puppet(point(R"("background": "pink")")), "background");
    expect_refused(warp_puppet(point(R"("cutout": {"from": "magic"})")), "cutout.from");
}

TEST_F(BadInput, PuppetWhosePictureIsMissing) {
    expect_refused(warp_puppet(R"({"format": "puppetwarp", "version": 1, "image": "gone.png",
        "handles": [{"id": "a", "type": "point", "at": [1, 2]}]})"),
                   "gone.png");
    expect_refused(warp_puppet(R"({"format": "puppetwarp", "version": 1,
        "handles": [{"id": "a", "type": "point", "at": [1, 2]}]})"),
                   "picture");
}

TEST_F(BadInput, OutputsThatCannotBe) {
    const auto to = [&](const std::string& output) {
        return puppetwarp_command({"warp", good, "--pin", "60,50", "-o", output});
    };
    expect_refused(to(folder / "nowhere/out.png"), "nowhere");
    expect_refused(to(folder / "out.xyz"), "xyz");
    expect_refused(to(folder / "out"), "extension");
    expect_refused(to(folder.path().string()), "");
    expect_refused(to(good), "--force");
    expect_refused(puppetwarp_command({"warp", good, "--pin", "60,50", "-o", "-", "--json"}), "standard output");
}

TEST_F(BadInput, OutputsThatWouldDestroyInputsOrEachOther) {
    const std::string before = bytes_of(good);
    const auto with = [&](std::vector<std::string> more) {
        more.insert(more.begin(), {"warp", good, "--pin", "60,50"});
        return puppetwarp_command(more);
    };
    expect_refused(with({"-o", out, "--report", good}), "--force");
    expect_refused(with({"-o", out, "--report", out}), "two results");
    expect_refused(with({"-o", out, "--report", folder / "nowhere/r.json"}), "nowhere");
    expect_refused(with({"-o", "/dev/stdout", "--json"}), "standard output");
    expect_refused(with({"-o", "-", "--report", "/dev/stdout"}), "standard output");
    expect_refused(puppetwarp_command({"diff", good, photo, "--report", good}),
                   "is the input itself (choose another name)");
    expect_refused(puppetwarp_command({"diff", good, photo, "--heatmap", photo}),
                   "is the input itself (choose another name)");
    EXPECT_EQ(bytes_of(good), before);
    EXPECT_FALSE(fs::exists(out));

    write_image(disc_picture(120, 100), folder / "mask.png");
    put_bytes(folder / "m.json", R"({"format": "puppetwarp", "version": 1, "image": "good.png",
        "cutout": {"from": "mask", "path": "mask.png"}, "handles": [{"id": "a", "type": "point", "at": [60, 50]}]})");
    expect_refused(puppetwarp_command({"warp", folder / "m.json", "-o", folder / "mask.png"}), "--force");
    EXPECT_EQ(puppetwarp_command({"warp", folder / "m.json", "-o", out}).exit_code, 0);
}

TEST_F(BadInput, NothingToFillABackgroundFrom) {
    expect_refused(warp(photo, {"--pin", "40,30", "--background", "inpaint"}), "whole picture");
    expect_refused(warp(good, {"--pin", "60,50", "--background", "inpaint"}), "nothing around the subject");
}

TEST_F(BadInput, EmptyWordsAreNotDefaults) {
    for (const char* option :
         {"--method", "--arap-energy", "--background", "--back-faces", "--pose", "--canvas", "--interpolation",
          "--image", "--displacement", "--displacement-in", "--mesh-out", "--scale"}) {
        const CommandResult result = warp(good, {"--pin", "60,50", option, ""});
        EXPECT_EQ(result.exit_code, 2) << option;
    }
    EXPECT_EQ(puppetwarp_command({"warp", good, "--pin", "60,50", "-o", ""}).exit_code, 2);
}

TEST_F(BadInput, ForceReplacesTheInput) {
    const std::string before = bytes_of(good);
    EXPECT_EQ(puppetwarp_command({"warp", good, "--pin", "60,50:65,55", "-o", good, "--force"}).exit_code, 0);
    EXPECT_NE(bytes_of(good), before);
}

TEST_F(BadInput, ReadOnlyFolder) {
    using fs::perms;
    fs::permissions(folder.path(), perms::owner_read | perms::owner_exec | perms::others_read | perms::others_exec);
    // Root may write everywhere: then the command runs as nobody.
    constexpr uid_t nobody = 65534;
    const CommandResult result = puppetwarp_command({"warp", good, "--pin", "60,50", "-o", out}, [] {
        if (::geteuid() == 0 && (::setgid(nobody) != 0 || ::setuid(nobody) != 0)) ::_exit(126);
    });
    if (result.exit_code == 127) GTEST_SKIP() << "the program lies in a folder that only root can read";
    expect_refused(result, "cannot be written");
    EXPECT_FALSE(fs::exists(out));
}

TEST_F(BadInput, FullDiskKeepsTheOldFile) {
    put_bytes(out, "what was there before");
    Image noise = noise_picture(300, 300, CV_8UC3);
    write_image(noise, photo);
    const CommandResult result = puppetwarp_command({"warp", photo, "--pin", "60,50", "-o", out}, [] {
        const rlimit limit{20000, 20000};
        ::setrlimit(RLIMIT_FSIZE, &limit);
    });
    expect_refused(result, "out.png", 3);
    EXPECT_EQ(bytes_of(out), "what was there before");
    for (const auto& entry : fs::directory_iterator(folder.path())) {
        EXPECT_THAT(entry.path().filename().string(), testing::Not(testing::StartsWith(".puppetwarp"))) << entry;
    }
}

TEST_F(BadInput, DiffCannotCompare) {
    expect_refused(puppetwarp_command({"diff", good, folder / "missing.png"}), "missing.png");
    expect_refused(puppetwarp_command({"diff", good, good, "--threshold", "2"}), "--threshold");
    expect_refused(puppetwarp_command({"diff", good, good, "--threshold", "-1"}), "--threshold");
    expect_refused(puppetwarp_command({"diff", good, good, "--threshold", "nan"}), "--threshold");
    expect_refused(puppetwarp_command({"diff", good, good, "--heatmap", folder / "nowhere/map.png"}), "nowhere");
}

TEST_F(BadInput, MeshesThatAreNone) {
    put_bytes(folder / "rig.json", R"({"format": "puppetwarp", "version": 1,
        "handles": [{"id": "v", "type": "vertex", "index": 0}]})");
    const auto deform = [&](const std::string& mesh) {
        put_bytes(folder / "m.off", mesh);
        return puppetwarp_command(
            {"deform", folder / "m.off", "--rig", folder / "rig.json", "-o", folder / "moved.csv"});
    };
    EXPECT_EQ(deform("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n").exit_code, 0);
    expect_refused(deform("PLY\n"), "m.off");
    expect_refused(deform("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 9\n"), "m.off");
    expect_refused(deform("OFF\n3 1 0\n0 0 0\nnan 0 0\n0 1 0\n3 0 1 2\n"), "m.off");
    expect_refused(deform("OFF\n1000000000 1 0\n0 0 0\n"), "m.off");
    expect_refused(deform("OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n"), "m.off");
    put_bytes(folder / "rig.json", R"({"format": "puppetwarp", "version": 1,
        "handles": [{"id": "v", "type": "vertex", "index": 3}]})");
    expect_refused(deform("OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"), "v");
}

// Meshes in files that are sound to read and bad to bend: a clear error, or positions that are numbers.
class BadMesh : public BadInput {
protected:
    CommandResult deform(const std::string& mesh, const std::string& handles, const std::string& targets,
                         const std::string& method) const {
        put_bytes(folder / "m.off", mesh);
        put_bytes(folder / "rig.json", R"({"format": "puppetwarp", "version": 1, "handles": [)" + handles +
                                           R"(], "poses": [{"name": "p", "handles": {)" + targets + "}}]}");
        fs::remove(folder / "moved.csv");
        return puppetwarp_command(
            {"deform", folder / "m.off", "--rig", folder / "rig.json", "--method", method, "-o", folder / "moved.csv"});
    }

    // \return whether there is a result at all.
    bool deforms_or_refuses(const std::string& mesh, const std::string& handles, const std::string& targets) const {
        bool any = false;
        for (const char* method : {"harmonic", "biharmonic", "arap"}) {
            const CommandResult result = deform(mesh, handles, targets, method);
            EXPECT_EQ(result.signal, 0) << method;
            if (result.exit_code != 0) {
                expect_refused(result, "");
                continue;
            }
            any = true;
            const std::string csv = bytes_of(folder / "moved.csv");
            EXPECT_EQ(csv.find("nan"), std::string::npos) << method;
            EXPECT_EQ(csv.find("inf"), std::string::npos) << method;
        }
        return any;
    }

    // n x n squares of 10 px.
    static std::string grid(int n) {
        std::string text = "OFF\n" + std::to_string((n + 1) * (n + 1)) + " " + std::to_string(2 * n * n) + " 0\n";
        for (int j = 0; j <= n; ++j) {
            for (int i = 0; i <= n; ++i) text += std::to_string(10 * i) + " " + std::to_string(10 * j) + " 0\n";
        }
        for (int j = 0; j < n; ++j) {
            for (int i = 0; i < n; ++i) {
                const int a = j * (n + 1) + i, b = a + 1, c = a + n + 1, d = c + 1;
                text += "3 " + std::to_string(a) + " " + std::to_string(b) + " " + std::to_string(d) + "\n";
                text += "3 " + std::to_string(a) + " " + std::to_string(d) + " " + std::to_string(c) + "\n";
            }
        }
        return text;
    }
    static std::string point(const std::string& id, const std::string& at) {
        return R"({"id": ")" + id + R"(", "type": "point", "at": [)" + at + "]}";
    }
};

TEST_F(BadMesh, FoldsAtRestNameTheTriangle) {
    const std::string folded = "OFF\n5 3 0\n0 0 0\n10 0 0\n10 10 0\n0 10 0\n2 5 0\n3 0 1 2\n3 0 2 3\n3 0 2 4\n";
    expect_refused(deform("OFF\n4 2 0\n0 0 0\n10 0 0\n10 10 0\n8 3 0\n3 0 1 2\n3 0 2 3\n",
                          R"({"id": "v", "type": "vertex", "index": 0})", "", "arap"),
                   "triangle ");
    expect_refused(deform(folded, R"({"id": "v", "type": "vertex", "index": 0})", "", "arap"), "triangles 1 and 2");
    // The one that is turned against the others is named, not the others against the first.
    expect_refused(deform("OFF\n5 3 0\n0 0 0\n10 0 0\n10 10 0\n0 10 0\n-5 5 0\n3 2 1 0\n3 0 2 3\n3 0 3 4\n",
                          R"({"id": "v", "type": "vertex", "index": 0})", "", "arap"),
                   "triangle 0 is turned");
}

TEST_F(BadMesh, AnEdgeOfThreeTrianglesIsRefused) {
    expect_refused(deform("OFF\n5 3 0\n0 0 0\n10 0 0\n5 10 0\n5 -10 0\n6 7 0\n3 0 1 2\n3 1 0 3\n3 0 1 4\n",
                          R"({"id": "v", "type": "vertex", "index": 0})", "", "arap"),
                   "triangles 0 and 2 lie on one side of the edge from vertex 0 to 1");
}

TEST_F(BadMesh, TwoFansAtAVertexAndTwoVerticesInOnePlaceAreBent) {
    const std::string bow = "OFF\n5 2 0\n0 0 0\n0 10 0\n5 5 0\n10 0 0\n10 10 0\n3 0 2 1\n3 2 3 4\n";
    EXPECT_TRUE(deforms_or_refuses(bow, point("a", "2, 5") + ", " + point("b", "8, 5"), R"("b": {"to": [9, 6]})"));
    const std::string slit = "OFF\n6 2 0\n0 0 0\n10 0 0\n10 10 0\n0 0 0\n10 10 0\n0 10 0\n3 0 1 2\n3 3 4 5\n";
    EXPECT_TRUE(deforms_or_refuses(slit, R"({"id": "a", "type": "vertex", "index": 0})", R"("a": {"to": [1, 0]})"));
    EXPECT_TRUE(deforms_or_refuses(slit, R"({"id": "a", "type": "vertex", "index": 0},
                                            {"id": "b", "type": "vertex", "index": 3})",
                                   R"("a": {"to": [1, 0]})"));
}

TEST_F(BadMesh, SliversGiveNumbersOrAnError) {
    for (const char* height : {"1e-2", "1e-5", "1e-8", "1e-11"}) {
        const std::string h = height;
        const std::string sliver = "OFF\n5 3 0\n0 0 0\n10 0 0\n5 -" + h +
                                   " 0\n5 -10 0\n5 8 0\n"
                                   "3 2 1 0\n3 2 0 3\n3 1 2 3\n";
        deforms_or_refuses(sliver,
                           R"({"id": "a", "type": "vertex", "index": 3}, {"id": "b", "type": "vertex", "index": 1})",
                           R"("a": {"to": [7, -11]})");
    }
}

TEST_F(BadMesh, PinsOutsideAreMovedOntoTheMeshWhereAsked) {
    const std::string mesh = "OFF\n3 1 0\n0 0 0\n10 0 0\n0 10 0\n3 0 1 2\n";
    expect_refused(deform(mesh, point("a", "-3, 5"), "", "arap"), "--pin-snap");
    const auto snapped = [&](const std::string& most) {
        return puppetwarp_command(
            {"deform", folder / "m.off", "--rig", folder / "rig.json", "-o", folder / "moved.csv", "--pin-snap", most});
    };
    expect_refused(snapped("2"), "--pin-snap");
    EXPECT_EQ(snapped("4").exit_code, 0);
}

TEST_F(BadMesh, HandlesThatSayLittleOrTooMuch) {
    const std::string mesh = grid(8);
    EXPECT_TRUE(deforms_or_refuses(mesh, point("a", "40, 40"), R"("a": {"to": [45, 45], "rotate_deg": 30})"));
    EXPECT_TRUE(deforms_or_refuses(mesh, point("a", "40, 40"), R"("a": {"to": [45, 45]})"));
    EXPECT_TRUE(deforms_or_refuses(mesh, point("a", "10, 40") + "," + point("b", "40, 40") + "," + point("c", "70, 40"),
                                   R"("b": {"to": [40, 45]})"));
    EXPECT_TRUE(deforms_or_refuses(mesh, point("a", "40, 40") + "," + point("b", "40, 40") + "," + point("c", "40, 40"),
                                   R"("a": {"to": [45, 45]}, "b": {"to": [45, 45]}, "c": {"to": [45, 45]})"));
    for (const char* method : {"harmonic", "biharmonic", "arap"}) {
        expect_refused(
            deform(mesh, point("a", "40, 40") + "," + point("b", "20, 20"), R"("a": {"to": [1e12, 0]})", method),
            "too far");
    }
}

}  // namespace
}  // namespace puppetwarp::tests
