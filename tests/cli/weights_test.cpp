// `puppetwarp weights`: what scripts rely on, and what is wrong with handles that `warp` and `deform` refuse alike.

#include "pictures.h"
#include "support/run_command.h"

#include <puppetwarp/image/read.h>
#include <puppetwarp/image/write.h>
#include <puppetwarp/mesh/mesh_file.h>
#include <puppetwarp/weights/weights.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <sstream>

#include <unistd.h>

namespace puppetwarp::tests {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using testing::HasSubstr;

// n x n squares over [0, size] x [0, size]; `apart`: a second such board to the right of the first.
std::string grid_off(int n, double size, bool apart = false) {
    std::ostringstream vertices, triangles;
    const int boards = apart ? 2 : 1, each = (n + 1) * (n + 1);
    for (int board = 0; board < boards; ++board) {
        for (int k = 0; k < each; ++k) {
            vertices << size * (k % (n + 1)) / n + 1.5 * size * board << ' ' << size * (k / (n + 1)) / n << " 0\n";
        }
        for (int k = 0; k < n * n; ++k) {
            const int a = board * each + k / n * (n + 1) + k % n;
            triangles << "3 " << a << ' ' << a + 1 << ' ' << a + n + 2 << "\n3 " << a << ' ' << a + n + 2 << ' '
                      << a + n + 1 << '\n';
        }
    }
    return "OFF\n" + std::to_string(boards * each) + " " + std::to_string(2 * boards * n * n) + " 0\n" +
           vertices.str() + triangles.str();
}

std::string point(const std::string& id, double x, double y) {
    return Json({{"id", id}, {"type", "point"}, {"at", {x, y}}}).dump();
}

const std::string& three_points() {
    static const std::string all = point("a", 60, 70) + "," + point("b", 140, 80) + "," + point("c", 100, 150);
    return all;
}

class WeightsCommand : public testing::Test {
protected:
    WeightsCommand() {
        put_bytes(mesh, grid_off(16, 200));
        write_image(disc_picture(200, 200), folder / "disc.png");
    }

    // A rig for meshes and a puppet of a disc with the same handles.
    void use(const std::string& handles) const {
        const std::string rest = R"("handles": [)" + handles + "]}";
        put_bytes(rig, R"({"format": "puppetwarp", "version": 1, )" + rest);
        put_bytes(puppet, R"({"format": "puppetwarp", "version": 1, "image": "disc.png", )" + rest);
    }
    CommandResult weights(std::vector<std::string> more) const {
        more.insert(more.begin(), {"weights", mesh, "--rig", rig});
        return puppetwarp_command(more);
    }
    Json report_of(std::vector<std::string> more) const {
        more.insert(more.end(), {"-o", csv, "--json"});
        const CommandResult result = weights(more);
        EXPECT_EQ(result.exit_code, 0) << result.errors;
        return result.exit_code == 0 ? Json::parse(result.output) : Json();
    }
    std::string csv_of(std::vector<std::string> more) const {
        more.insert(more.end(), {"-o", "-"});
        const CommandResult result = weights(more);
        EXPECT_EQ(result.exit_code, 0) << result.errors;
        return result.output;
    }
    static void expect_refused(const CommandResult& result, const std::string& mentions) {
        EXPECT_EQ(result.exit_code, 2) << result.errors;
        EXPECT_EQ(result.signal, 0);
        EXPECT_THAT(result.errors, testing::StartsWith("puppetwarp: "));
        EXPECT_EQ(std::count(result.errors.begin(), result.errors.end(), '\n'), 1) << result.errors;
        EXPECT_THAT(result.errors, HasSubstr(mentions));
        EXPECT_EQ(result.output, "");
    }
    // By every command that uses weights, of a mesh and of a picture; nothing is left.
    void expect_refused_everywhere(const std::string& handles, const std::string& mentions) const {
        SCOPED_TRACE(mentions);
        use(handles);
        const std::string png = folder / "out.png";
        expect_refused(weights({"-o", csv}), mentions);
        expect_refused(puppetwarp_command({"weights", puppet, "-o", csv}), mentions);
        expect_refused(puppetwarp_command({"deform", mesh, "--rig", rig, "--method", "lbs", "-o", csv}), mentions);
        expect_refused(puppetwarp_command({"warp", puppet, "--method", "lbs", "-o", png}), mentions);
        EXPECT_FALSE(fs::exists(csv));
        EXPECT_FALSE(fs::exists(png));
        EXPECT_FALSE(fs::exists(folder / "rig.weights"));
    }

    TemporaryFolder folder;
    std::string mesh = folder / "m.off";
    std::string rig = folder / "rig.json";
    std::string puppet = folder / "p.puppet.json";
    std::string csv = folder / "w.csv";
};

TEST_F(WeightsCommand, HandlesThatCannotBeAreRefusedEverywhere) {
    const std::string bone = R"({"id": "b", "type": "bone", "from": )",
                      cage = R"({"id": "h", "type": "cage", "points": )";
    expect_refused_everywhere(bone + R"([90, 90], "to": [90, 90]})", "no length");
    expect_refused_everywhere(bone + R"([90, 90], "to": [390, 90]})", "outside the subject");
    expect_refused_everywhere(
        bone + R"([60, 100], "to": [140, 100]}, {"id": "c", "type": "bone", "from": [100, 60], "to": [100, 140]})",
        "the bones cross each other at (100, 100)");
    expect_refused_everywhere(point("one", 90, 90) + "," + point("two", 90, 90), "they hold one vertex");
    expect_refused_everywhere(bone + R"([60, 90], "to": [90, 90], "parent": "c"},
               {"id": "c", "type": "bone", "from": [90, 90], "to": [120, 90], "parent": "b"})",
                              "loop");
    expect_refused_everywhere(bone + R"([60, 90], "to": [90, 90], "parent": "b"})", "loop");
    expect_refused_everywhere(bone + R"([60, 90], "to": [90, 90], "parent": "nobody"})", "nobody");
    expect_refused_everywhere(cage + "[[-10, -10], [210, 210], [210, -10], [-10, 210]]}", "crosses or touches itself");
    expect_refused_everywhere(cage + "[[300, 0], [400, 0], [400, 100]]}", "leaves the subject outside");
    expect_refused_everywhere(cage + "[[0, 0], [200, 0]]}", "3 points");
    expect_refused_everywhere(cage + "[[-1e300, -1e300], [1e300, -1e300], [0, 1e300]]}", "too far");
    expect_refused_everywhere("", "no ");
    expect_refused_everywhere(point("far", 1e300, 50), "far");
    expect_refused_everywhere(R"({"id": "n", "type": "point", "at": [null, 50]})", "must be a number");
    expect_refused_everywhere(R"({"id": "n", "type": "point", "at": [NaN, 50]})", "is not JSON");
    expect_refused_everywhere(R"({"id": "n", "type": "point", "at": [1e999, 50]})", "too large");
    expect_refused_everywhere(R"({"id": "r", "type": "region", "points": [[90, 90], [90.1, 90], [90, 90.1]]})",
                              "no vertex of the mesh lies inside the region");
}

TEST_F(WeightsCommand, OptionsThatCannotBeAreRefused) {
    use(three_points());
    const auto refuse = [&](std::vector<std::string> more, const std::string& mentions) {
        if (std::find(more.begin(), more.end(), "-o") == more.end()) more.insert(more.end(), {"-o", csv});
        expect_refused(weights(more), mentions);
    };
    for (const char* option : {"--kind", "--partition"}) {
        refuse({option, "nosuch"}, "known: ");
        refuse({option, ""}, "known: ");
    }
    refuse({"--kind", "harmonic-cage"}, "no cage");
    for (const char* kind : {"mean-value", "green", "cauchy"}) refuse({"--kind", kind}, "a formula of one cage");
    for (const char* budget : {"0", "-1", "1.01", "nan", "x"})
        refuse({"--kind", "l1", "--l1-budget", budget}, "budget");
    for (const char* count : {"0", "-3", "1.5", "x"}) refuse({"--max-iterations", count}, "--max-iterations");
    for (const char* small : {"0", "-1e-8", "nan"}) refuse({"--tolerance", small}, "--tolerance");
    for (const char* pin : {"nan,1", "5", "1e400,5", ""}) refuse({"--pin", pin}, "--pin");
    refuse({"--pin", "1e9,50"}, "outside the subject");
    refuse({"--pin-snap", "-1"}, "--pin-snap");
    refuse({"-o", folder / "w.png", "--columns", "65"}, "columns");
    refuse({"-o", folder / "w.png", "--cell-px", "5"}, "cell");
    refuse({"-o", folder / "nowhere/w.csv"}, "nowhere");
    refuse({"-o", folder / "w.xyz"}, "no format of weights");
    refuse({"-o", folder.path().string()}, "no format of weights");
    refuse({"-o", "-", "--json"}, "standard output");
    refuse({"-o", csv, "--report", csv}, "two results");
    EXPECT_FALSE(fs::exists(csv));
    expect_refused(puppetwarp_command({"weights", mesh, "-o", csv}), "--rig");
    expect_refused(puppetwarp_command({"weights", folder / "disc.png", "--rig", rig, "-o", csv}), "goes with a mesh");
    expect_refused(puppetwarp_command({"weights", folder / "missing.off", "--rig", rig, "-o", csv}), "missing.off");
}

TEST_F(WeightsCommand, VerticesOfAMeshFileMustBeThere) {
    const auto vertex = [](const std::string& id, int index) {
        return Json({{"id", id}, {"type", "vertex"}, {"index", index}}).dump();
    };
    use(vertex("v", 0) + "," + vertex("w", 288));
    EXPECT_THAT(csv_of({"--kind", "harmonic"}), testing::StartsWith("v,w\n1,0\n"));
    use(vertex("v", 289));
    expect_refused(weights({"-o", csv}), "index 289 is not a vertex: the mesh has 289");
    use(vertex("v", -1));
    expect_refused(weights({"-o", csv}), "negative");
    use(vertex("v", 7) + "," + vertex("w", 7));
    expect_refused(weights({"-o", csv}), "they hold one vertex");
}

// The library's numbers, each to the bit, in the order of the rig.
TEST_F(WeightsCommand, CsvAndDmatHoldAllDigits) {
    use(point("plain", 60, 70) + "," + point("comma, \"quoted\"", 140, 80) + "," + point("c", 100, 150));
    const Rig handles{{{"plain", PointHandle{{60, 70}, {}}},
                       {"comma, \"quoted\"", PointHandle{{140, 80}, {}}},
                       {"c", PointHandle{{100, 150}, {}}}},
                      {}};
    Progress progress;
    const Weights expected = compute_weights(read_mesh(mesh), handles, {.kind = WeightKind::biharmonic}, progress);
    std::istringstream rows(csv_of({"--kind", "biharmonic"}));
    std::string line;
    std::getline(rows, line);
    EXPECT_EQ(line, "plain,\"comma, \"\"quoted\"\"\",c");
    for (Eigen::Index v = 0; v < expected.W.rows(); ++v) {
        ASSERT_TRUE(std::getline(rows, line));
        std::istringstream cells(line);
        for (Eigen::Index j = 0; j < 3; ++j) {
            std::string cell;
            std::getline(cells, cell, ',');
            EXPECT_EQ(std::strtod(cell.c_str(), nullptr), expected.W(v, j)) << v << ' ' << j;
        }
        EXPECT_TRUE(cells.eof());
    }
    EXPECT_FALSE(std::getline(rows, line));

    ASSERT_EQ(weights({"--kind", "biharmonic", "-o", folder / "w.dmat"}).exit_code, 0);
    std::istringstream dmat(bytes_of(folder / "w.dmat"));
    int columns = 0, count = 0;
    dmat >> columns >> count;
    EXPECT_EQ(columns, 3);
    EXPECT_EQ(count, expected.W.rows());
    for (const double value : expected.W.reshaped()) {
        std::string word;
        ASSERT_TRUE(dmat >> word);
        EXPECT_EQ(std::strtod(word.c_str(), nullptr), value);
    }
    std::string more;
    EXPECT_FALSE(dmat >> more);
}

TEST_F(WeightsCommand, ComplexWeightsHaveTwoColumnsACorner) {
    use(R"({"id": "hull", "type": "cage", "points": [[-9, -9], [209, -9], [209, 209], [-9, 209]]})");
    EXPECT_THAT(csv_of({"--kind", "cauchy"}),
                testing::StartsWith("hull[0].re,hull[0].im,hull[1].re,hull[1].im,hull[2].re,hull[2].im,hull[3].re,"
                                    "hull[3].im\n"));
    EXPECT_EQ(csv_of({"--kind", "green"}), csv_of({"--kind", "cauchy"}));
    EXPECT_THAT(csv_of({"--kind", "mean-value"}), testing::StartsWith("hull[0],hull[1],hull[2],hull[3]\n"));
}

TEST_F(WeightsCommand, PicturesAreSheetsOfMaps) {
    use(three_points());
    const auto sheet = [&](std::vector<std::string> more) {
        more.insert(more.end(), {"--kind", "bbw", "-o", folder / "w.png"});
        const CommandResult result = weights(more);
        EXPECT_EQ(result.exit_code, 0) << result.errors;
        return read_image(folder / "w.png").pixels;
    };
    const cv::Mat row = sheet({"--columns", "3", "--cell-px", "150"});
    const cv::Mat column = sheet({"--columns", "1", "--cell-px", "150"});
    const cv::Mat large = sheet({"--columns", "3", "--cell-px", "300"});
    EXPECT_GE(row.cols, 3 * 150);
    EXPECT_LT(column.cols, row.cols / 2);
    EXPECT_GT(column.rows, 3 * 150);
    EXPECT_GE(large.cols, 3 * 300);
    EXPECT_GE(large.rows, row.rows + 150);
    const std::string before = bytes_of(folder / "w.png");
    ASSERT_EQ(weights({"--columns", "3", "--cell-px", "300", "--kind", "harmonic", "-o", folder / "w.png"}).exit_code,
              0);
    EXPECT_NE(bytes_of(folder / "w.png"), before);
}

TEST_F(WeightsCommand, ReportHasItsFields) {
    use(three_points());
    const Json report = report_of({"--kind", "bbw", "--report", folder / "report.json"});
    for (const char* key : {"kind", "vertices", "handles", "iterations", "converged", "min", "max", "partition_error",
                            "kkt_residual", "fallback", "timings_ms"}) {
        EXPECT_TRUE(report.contains(key)) << key;
    }
    EXPECT_EQ(report["kind"], "bbw");
    EXPECT_EQ(report["vertices"], 289);
    EXPECT_EQ(report["handles"], 3);
    EXPECT_GT(report["iterations"], 0);
    EXPECT_EQ(report["converged"], true);
    EXPECT_EQ(report["min"], 0);
    EXPECT_EQ(report["max"], 1);
    EXPECT_LE(report["partition_error"].get<double>(), 1e-9);
    EXPECT_LE(report["kkt_residual"].get<double>(), 1e-8);
    EXPECT_TRUE(report["fallback"].is_null());
    EXPECT_EQ(Json::parse(bytes_of(folder / "report.json"))["min"], report["min"]);
    EXPECT_LT(report_of({"--kind", "biharmonic"})["min"].get<double>(), -1e-3);
}

TEST_F(WeightsCommand, SaysWhatDidNotConvergeAndWhatFinishedIt) {
    use(three_points());
    for (const char* kind : {"bbw", "l1", "monotonic"}) {
        const CommandResult result =
            weights({"--kind", kind, "--max-iterations", "1", "--no-cache", "-o", csv, "--json"});
        EXPECT_EQ(result.exit_code, 0) << kind;
        const Json report = Json::parse(result.output);
        EXPECT_EQ(report["converged"], false) << kind;
        EXPECT_GT(report["kkt_residual"].get<double>(), 1e-8) << kind;
        EXPECT_THAT(result.errors, HasSubstr("the weights did not converge: KKT residual")) << kind;
        EXPECT_THAT(report["warnings"].back().get<std::string>(), HasSubstr("did not converge")) << kind;
    }
    const CommandResult finished = weights({"--max-iterations", "4", "--no-cache", "-o", csv, "--json"});
    EXPECT_EQ(Json::parse(finished.output)["fallback"], "projected Newton");
    EXPECT_THAT(finished.errors, HasSubstr("the weights were finished by projected Newton"));
    EXPECT_THAT(weights({"--max-iterations", "4", "-q", "-o", csv}).errors, "");
    EXPECT_LE(report_of({"--tolerance", "1e-12"})["kkt_residual"].get<double>(), 1e-12);
}

TEST_F(WeightsCommand, APartWithoutAHandleGoesToTheNearest) {
    put_bytes(mesh, grid_off(8, 200, true));
    use(three_points());
    for (const char* kind : {"harmonic", "bbw", "monotonic"}) {
        const CommandResult result = weights({"--kind", kind, "-o", csv, "--json"});
        ASSERT_EQ(result.exit_code, 0) << result.errors;
        const Json warnings = Json::parse(result.output)["warnings"];
        ASSERT_EQ(warnings.size(), 1u) << kind;
        EXPECT_THAT(warnings[0].get<std::string>(), testing::AllOf(HasSubstr("no handle"), HasSubstr("'b'")));
        EXPECT_THAT(result.errors, HasSubstr("warning: "));
        EXPECT_THAT(bytes_of(csv), testing::EndsWith("\n0,1,0\n"));
    }
}

TEST_F(WeightsCommand, TakesTwoHundredHandles) {
    put_bytes(mesh, grid_off(45, 450));
    std::string handles;
    for (int k = 0; k < 200; ++k) {
        handles += (k > 0 ? "," : "") + point("p" + std::to_string(k), 30 + 20 * (k % 20), 30 + 40 * (k / 20));
    }
    use(handles);
    for (const char* partition : {"coupled", "normalised"}) {
        const Json report = report_of({"--partition", partition, "--no-cache"});
        EXPECT_EQ(report["handles"], 200);
        EXPECT_EQ(report["converged"], true) << partition;
        EXPECT_LE(report["partition_error"].get<double>(), 1e-9);
        EXPECT_TRUE(report["fallback"].is_null());
    }
}

TEST_F(WeightsCommand, SameBytesForAnyNumberOfThreads) {
    put_bytes(mesh, grid_off(30, 200));
    use(three_points());
    for (const std::vector<std::string>& kind :
         {std::vector<std::string>{"bbw"}, {"bbw", "--partition", "normalised"}, {"l1"}, {"monotonic"}, {"harmonic"}}) {
        std::vector<std::string> arguments{"--no-cache", "--kind"};
        arguments.insert(arguments.end(), kind.begin(), kind.end());
        std::vector<std::string> one = arguments, seven = arguments;
        one.insert(one.end(), {"-j", "1"});
        seven.insert(seven.end(), {"-j", "7"});
        EXPECT_TRUE(csv_of(one) == csv_of(seven)) << kind[0];
    }
    const auto sheet = [&](const std::string& threads) {
        EXPECT_EQ(weights({"-j", threads, "-o", folder / "w.png"}).exit_code, 0);
        return bytes_of(folder / "w.png");
    };
    EXPECT_TRUE(sheet("1") == sheet("7"));
}

// Whatever the file beside the rig holds, the answer is that of a run without it.
TEST_F(WeightsCommand, KeptWeightsNeverMeetAnotherQuestion) {
    const std::string kept = folder / "rig.weights";
    use(three_points());
    const std::string first = csv_of({"--kind", "bbw"});
    ASSERT_TRUE(fs::exists(kept));
    const std::string bytes = bytes_of(kept);
    EXPECT_TRUE(csv_of({"--kind", "bbw"}) == first);
    EXPECT_TRUE(bytes_of(kept) == bytes);
    const auto expect_fresh = [&](const char* what, const std::vector<std::string>& more = {"--kind", "bbw"}) {
        std::vector<std::string> alone = more;
        alone.push_back("--no-cache");
        const std::string with = csv_of(more);
        EXPECT_TRUE(with == csv_of(alone)) << what;
        EXPECT_FALSE(with == first) << what;
    };
    expect_fresh("a kind", {"--kind", "monotonic"});
    expect_fresh("a partition", {"--kind", "bbw", "--partition", "normalised"});
    expect_fresh("a pin", {"--kind", "bbw", "--pin", "100,100"});
    use(point("a", 60, 70) + "," + point("b", 140, 80) + "," + point("c", 100, 130));
    expect_fresh("a moved handle");
    use(three_points());
    put_bytes(mesh, grid_off(16, 201));
    expect_fresh("a changed mesh");
    put_bytes(kept, "nonsense");
    expect_fresh("a broken file");
    fs::remove(kept);
    csv_of({"--kind", "bbw", "--no-cache"});
    csv_of({"--kind", "harmonic"});
    EXPECT_FALSE(fs::exists(kept));
    // Other commands keep and use the same.
    EXPECT_EQ(puppetwarp_command({"deform", mesh, "--rig", rig, "--method", "lbs", "-o", csv}).exit_code, 0);
    EXPECT_TRUE(fs::exists(kept));
}

TEST_F(WeightsCommand, StandardOutputTakesTheNumbers) {
    use(three_points());
    ASSERT_EQ(weights({"-o", csv}).exit_code, 0);
    EXPECT_EQ(csv_of({}), bytes_of(csv));
    EXPECT_THAT(puppetwarp_command({"weights", "--help"}).output, HasSubstr("Example:"));
}

TEST_F(WeightsCommand, PuppetFilesAndPicturesWithPinsWorkToo) {
    use(three_points());
    EXPECT_EQ(puppetwarp_command({"weights", puppet, "-o", csv}).exit_code, 0);
    EXPECT_THAT(bytes_of(csv), testing::StartsWith("a,b,c\n"));
    EXPECT_TRUE(fs::exists(folder / "p.puppet.weights"));
    EXPECT_EQ(puppetwarp_command({"weights", folder / "disc.png", "--pin", "70,100", "--pin", "130,100", "-o", csv})
                  .exit_code,
              0);
    EXPECT_THAT(bytes_of(csv), testing::StartsWith("pin1,pin2\n"));
}

// Ctrl-C in the midst of it: the old file stays whole, nothing else is left.
TEST_F(WeightsCommand, EndedByASignalItLeavesNothing) {
    put_bytes(mesh, grid_off(200, 200));
    use(three_points());
    put_bytes(csv, "what was there before");
    for (const int signal : {SIGINT, SIGTERM, SIGKILL}) {
        const CommandResult result =
            puppetwarp_command({"weights", mesh, "--rig", rig, "--kind", "monotonic", "-o", csv}, [signal] {
                const pid_t command = ::getpid();
                if (::fork() != 0) return;  // who goes on as the command
                ::sleep(1);
                ::kill(command, signal);
                ::_exit(0);
            });
        EXPECT_EQ(result.signal, signal) << result.errors;
        EXPECT_EQ(bytes_of(csv), "what was there before");
        std::vector<std::string> names;
        for (const auto& entry : fs::directory_iterator(folder.path())) names.push_back(entry.path().filename());
        EXPECT_THAT(names, testing::UnorderedElementsAre("disc.png", "m.off", "p.puppet.json", "rig.json", "w.csv"));
    }
}

}  // namespace
}  // namespace puppetwarp::tests
