// What scripts rely on in `compare-methods`: exit codes, the report, the same bytes.

#include "pictures.h"
#include "support/run_command.h"

#include <puppetwarp/image/read.h>
#include <puppetwarp/image/write.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>

namespace puppetwarp::tests {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using testing::HasSubstr;

class CompareMethods : public testing::Test {
protected:
    CompareMethods() { write_image(disc_picture(100, 80), picture); }

    CommandResult run(std::vector<std::string> more) const {
        more.insert(more.begin(), {"compare-methods", picture, "-o", sheet, "--cell-px", "120"});
        return puppetwarp_command(more);
    }

    CommandResult run_puppet(const std::string& pose, std::vector<std::string> more) const {
        put_bytes(folder / "test.puppet.json", R"({"format": "puppetwarp", "version": 1, "image": "picture.png",
            "handles": [{"id": "left", "type": "point", "at": [30, 40]}, {"id": "right", "type": "point", "at": [65, 40]}],
            "poses": [{"name": "first", "handles": {"right": )" +
                                                   pose + "}}]}");
        more.insert(more.begin(), {"compare-methods", folder / "test.puppet.json", "-o", sheet});
        return puppetwarp_command(more);
    }

    void expect_refused(const CommandResult& result, const std::string& mentions) const {
        EXPECT_EQ(result.exit_code, 2) << result.errors;
        EXPECT_THAT(result.errors, testing::StartsWith("puppetwarp: "));
        EXPECT_EQ(std::count(result.errors.begin(), result.errors.end(), '\n'), 1) << result.errors;
        EXPECT_THAT(result.errors, HasSubstr(mentions));
        EXPECT_EQ(result.output, "");
        EXPECT_FALSE(fs::exists(sheet));
    }

    TemporaryFolder folder;
    std::string picture = folder / "picture.png";
    std::string sheet = folder / "sheet.png";
    std::vector<std::string> pins{"--pin", "30,40", "--pin", "65,40:70,30"};

    std::vector<std::string> with_pins(std::vector<std::string> more) const {
        more.insert(more.end(), pins.begin(), pins.end());
        return more;
    }
};

TEST_F(CompareMethods, ReportsEachMethodAsDeformDoes) {
    const CommandResult result = run(with_pins({"--json", "--report", folder / "report.json"}));
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_EQ(bytes_of(folder / "report.json"), result.output);
    const Json report = Json::parse(result.output);
    ASSERT_GT(report["methods"].size(), 4U);
    for (const Json& method : report["methods"]) {
        const std::string label = method["label"];
        EXPECT_EQ(label.find(method["method"].get<std::string>()), 0U);
        EXPECT_TRUE(method["error"].is_null()) << method["error"];
        EXPECT_TRUE(method["energy"].is_number()) << label;
        EXPECT_TRUE(method["iterations"].is_number_integer()) << label;
        EXPECT_TRUE(method["converged"].get<bool>()) << label;
        EXPECT_EQ(method["flipped_triangles"], 0) << label;
        EXPECT_GE(method["max_stretch"], 1) << label;
        EXPECT_GE(method["max_area_ratio"], 1) << label;
        EXPECT_TRUE(method["max_handle_error_px"].is_number()) << label;
        EXPECT_TRUE(method["timings_ms"]["bind"].is_number()) << label;
        EXPECT_TRUE(method["timings_ms"]["deform"].is_number()) << label;
    }
    const Image image = read_image(sheet);
    EXPECT_EQ(report["sheet"]["width"], image.width());
    EXPECT_EQ(report["sheet"]["height"], image.height());
    EXPECT_GE(report["sheet"]["columns"].get<int>() * report["sheet"]["rows"].get<int>(),
              static_cast<int>(report["methods"].size()) + 1);
}

TEST_F(CompareMethods, SheetIsTheSameBytesEachTime) {
    for (const char* show : {"picture", "distortion"}) {
        ASSERT_EQ(run(with_pins({"--show", show, "-j", "1"})).exit_code, 0);
        const std::string first = bytes_of(sheet);
        ASSERT_EQ(run(with_pins({"--show", show, "-j", "4"})).exit_code, 0);
        EXPECT_TRUE(first == bytes_of(sheet)) << show;
    }
}

TEST_F(CompareMethods, TimingsHaveALineOfTheirOwn) {
    ASSERT_EQ(run(with_pins({"--methods", "arap"})).exit_code, 0);
    const int without = read_image(sheet).height();
    ASSERT_EQ(run(with_pins({"--methods", "arap", "--timings"})).exit_code, 0);
    EXPECT_GT(read_image(sheet).height(), without);
}

TEST_F(CompareMethods, AMethodThatCannotTakeThePoseIsAnAnswer) {
    const std::string affine = R"({"affine": [1, 0, 0.3, 1, 0, 0]})";
    const CommandResult result = run_puppet(affine, {"--methods", "biharmonic,arap", "--json"});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_THAT(result.errors, HasSubstr("warning: arap: "));
    const Json methods = Json::parse(result.output)["methods"];
    EXPECT_TRUE(methods[0]["error"].is_null());
    EXPECT_TRUE(methods[1]["error"].is_string());
    EXPECT_TRUE(methods[1]["energy"].is_null());
    fs::remove(sheet);
    expect_refused(run_puppet(affine, {"--methods", "arap"}), "right");
}

TEST_F(CompareMethods, PosesAreThoseOfThePuppetFile) {
    const CommandResult first = run_puppet(R"({"to": [70, 30]})", {"--methods", "harmonic", "--json"});
    ASSERT_EQ(first.exit_code, 0) << first.errors;
    EXPECT_EQ(Json::parse(first.output)["pose"], "first");
    const CommandResult rest = run_puppet(R"({"to": [70, 30]})", {"--methods", "harmonic", "--json", "--pose", "rest"});
    EXPECT_NEAR(Json::parse(rest.output)["methods"][0]["max_stretch"].get<double>(), 1, 1e-9);
    fs::remove(sheet);
    expect_refused(run_puppet(R"({"to": [70, 30]})", {"--pose", "second"}), "second");
}

TEST_F(CompareMethods, BadInputIsRefusedWithoutASheet) {
    expect_refused(run(with_pins({"--methods", "arap,magic"})), "known: ");
    expect_refused(run(with_pins({"--methods", "arap,arap"})), "twice");
    expect_refused(run(with_pins({"--methods", ""})), "--methods");
    expect_refused(run(with_pins({"--methods", "arap,,harmonic"})), "--methods");
    expect_refused(run(with_pins({"--methods", ","})), "--methods");
    expect_refused(run({}), "handles");
    expect_refused(run({"--pin", "2,2"}), "outside");
    expect_refused(run(with_pins({"--show", "weights"})), "--show");
    for (const char* columns : {"0", "-1", "65", "two"}) {
        expect_refused(run(with_pins({"--columns", columns})), "columns");
    }
    for (const char* size : {"0", "-5", "119", "2001", "big"}) {
        EXPECT_EQ(puppetwarp_command(with_pins({"compare-methods", picture, "-o", sheet, "--cell-px", size})).exit_code,
                  2)
            << size;
    }
    for (const char* output : {"sheet.txt", "sheet", "missing/sheet.png"}) {
        const CommandResult result = puppetwarp_command(with_pins({"compare-methods", picture, "-o", folder / output}));
        EXPECT_EQ(result.exit_code, 2) << output;
        EXPECT_FALSE(fs::exists(folder / output));
    }
    EXPECT_EQ(puppetwarp_command(with_pins({"compare-methods", folder / "none.png", "-o", sheet})).exit_code, 2);
    EXPECT_EQ(puppetwarp_command(with_pins({"compare-methods", picture, "-o", picture})).exit_code, 2);
    EXPECT_EQ(puppetwarp_command(with_pins({"compare-methods", picture, "-o", "-", "--json"})).exit_code, 2);
}

}  // namespace
}  // namespace puppetwarp::tests
