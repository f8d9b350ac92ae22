// What `info` tells of every kind of file, sound and unsound.

#include "pictures.h"
#include "support/run_command.h"

#include <puppetwarp/image/write.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <set>

namespace puppetwarp::tests {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using testing::HasSubstr;

const fs::path kSource = PUPPETWARP_SOURCE_DIR;

class Info : public testing::Test {
protected:
    // The one object of one file; its exit code and its line on standard error agree with it.
    static Json info(const fs::path& file, const std::vector<std::string>& options = {}) {
        std::vector<std::string> arguments{"info", "--json", file};
        arguments.insert(arguments.end(), options.begin(), options.end());
        const CommandResult result = puppetwarp_command(arguments);
        Json json = Json::parse(result.output);
        EXPECT_EQ(json["file"], file.string());
        if (json["error"].is_null()) {
            EXPECT_EQ(result.exit_code, 0) << file;
            EXPECT_EQ(result.errors, "");
            EXPECT_NE(json["sound"], false);
        } else {
            EXPECT_EQ(result.exit_code, 2) << file;
            EXPECT_EQ(result.errors, "puppetwarp: " + json["error"].get<std::string>() + "\n");
            EXPECT_EQ(json["sound"], false);
        }
        return json;
    }

    TemporaryFolder folder;
};

TEST_F(Info, OfAPictureInEveryFormatThatIsRead) {
    std::set<std::string> formats;
    for (const auto& entry : fs::directory_iterator(kSource / "tests/fuzz/corpus/image")) {
        const Json json = info(entry.path());
        EXPECT_EQ(json["kind"], "picture") << entry.path();
        EXPECT_EQ(json["sound"], true) << entry.path();
        EXPECT_EQ(json["bytes"], fs::file_size(entry.path()));
        EXPECT_GT(json["width"], 0);
        EXPECT_EQ(json["alpha"].get<bool>(), json["channels"].get<int>() % 2 == 0);
        formats.insert(json["format"]);
    }
    EXPECT_EQ(formats, std::set<std::string>(
                           {"exr", "gif", "hdr", "heif", "jpeg", "jpeg2000", "pfm", "png", "ppm", "tiff", "webp"}));
}

TEST_F(Info, OfAPictureIsWhatWasWritten) {
    Image picture = noise_picture(90, 70, CV_16UC4);
    picture.metadata.x_pixels_per_mm = picture.metadata.y_pixels_per_mm = 10;
    write_image(picture, folder / "deep.png");
    Json json = info(folder / "deep.png");
    EXPECT_EQ(json["width"], 90);
    EXPECT_EQ(json["height"], 70);
    EXPECT_EQ(json["channels"], 4);
    EXPECT_EQ(json["bits"], 16);
    EXPECT_EQ(json["alpha"], true);
    EXPECT_EQ(json["icc"], false);
    EXPECT_EQ(json["orientation"], 1);
    EXPECT_EQ(json["pages"], 1);
    EXPECT_NEAR(json["x_pixels_per_mm"].get<double>(), 10, 0.01);
    write_image(noise_picture(20, 10, CV_8UC1), folder / "grey.exr");
    json = info(folder / "grey.exr");
    EXPECT_EQ(json["format"], "exr");
    EXPECT_EQ(json["channels"], 1);
    EXPECT_EQ(json["bits"], 32);
    EXPECT_EQ(json["alpha"], false);
}

TEST_F(Info, OfAPictureThatBreaksOff) {
    write_image(noise_picture(200, 200, CV_8UC3), folder / "whole.tif");
    write_image(noise_picture(200, 200, CV_8UC3), folder / "whole.jpg");
    for (const std::string name : {"whole.tif", "whole.jpg"}) {
        const std::string bytes = bytes_of(folder / name);
        put_bytes(folder / name, bytes.substr(0, bytes.size() * 3 / 4));
        EXPECT_EQ(info(folder / name)["sound"], false) << name;
    }
    const Json json = info(folder / "whole.jpg");
    EXPECT_EQ(json["kind"], "picture");
    EXPECT_EQ(json["width"], 200);
    EXPECT_THAT(json["error"].get<std::string>(), HasSubstr("whole.jpg: "));
    const Json header = info(folder / "whole.jpg", {"--quick"});
    EXPECT_EQ(header["sound"], nullptr);
    EXPECT_EQ(header["width"], 200);
}

TEST_F(Info, OfAMesh) {
    const std::string square = "OFF\n4 2 0\n0 0 0\n3 0 0\n3 3 0\n0 3 0\n3 0 1 2\n3 0 2 3\n";
    put_bytes(folder / "square.off", square);
    put_bytes(folder / "SQUARE.OFF", square);
    for (const char* name : {"square.off", "SQUARE.OFF"}) {
        const Json json = info(folder / name);
        EXPECT_EQ(json["kind"], "mesh");
        EXPECT_EQ(json["sound"], true);
        EXPECT_EQ(json["format"], "off");
        EXPECT_EQ(json["vertices"], 4);
        EXPECT_EQ(json["triangles"], 2);
        EXPECT_EQ(json["edges"], 5);
        EXPECT_EQ(json["boundary_edges"], 4);
        EXPECT_EQ(json["components"], 1);
        EXPECT_EQ(json["clockwise"], true);
        EXPECT_EQ(json["area"], 9);
        EXPECT_NEAR(json["longest_edge"].get<double>(), 4.2426406871192851, 1e-12);
        EXPECT_NEAR(json["smallest_angle_deg"].get<double>(), 45, 1e-12);
        EXPECT_EQ(json["bounding_box"], Json({{"x", 0}, {"y", 0}, {"width", 3}, {"height", 3}}));
    }
    int count = 0;
    for (const auto& entry : fs::directory_iterator(kSource / "tests/fuzz/corpus/mesh_file")) {
        const Json json = info(entry.path());
        EXPECT_EQ(json["sound"], entry.path().filename().string().starts_with("good_")) << entry.path();
        EXPECT_EQ(json["kind"].is_null(), fs::file_size(entry.path()) == 0) << entry.path();
        ++count;
    }
    EXPECT_GT(count, 20);
}

TEST_F(Info, OfAPuppetFile) {
    for (const char* name : {"gingerbread", "figure", "ring", "tail", "photo", "jellyfish"}) {
        const fs::path file = kSource / "images" / (std::string(name) + ".puppet.json");
        const Json json = info(file), document = Json::parse(bytes_of(file));
        EXPECT_EQ(json["kind"], "puppet");
        EXPECT_EQ(json["sound"], true);
        EXPECT_EQ(json["version"], 1);
        EXPECT_EQ(json["image"], document["image"]);
        EXPECT_EQ(json["files"], Json::array({(kSource / "images" / document["image"]).string()}));
        EXPECT_EQ(json["method"], document.value(Json::json_pointer("/method/name"), "arap"));
        ASSERT_EQ(json["handle_ids"].size(), document["handles"].size());
        int handles = 0;
        for (const auto& [type, number] : json["handles"].items()) handles += number.get<int>();
        EXPECT_EQ(handles, static_cast<int>(document["handles"].size()));
        ASSERT_EQ(json["poses"].size(), document["poses"].size());
        EXPECT_EQ(json["poses"][0], document["poses"][0]["name"]);
        EXPECT_EQ(json["width"], info(kSource / "images" / document["image"])["width"]);
        EXPECT_GT(json["vertices"], 100);
        EXPECT_GT(json["triangles"], 100);
    }
}

TEST_F(Info, OfAPuppetFileThatCannotBeWarped) {
    put_bytes(folder / "lost.json", R"({"format": "puppetwarp", "version": 1, "image": "gone.png",
        "handles": [{"id": "a", "type": "point", "at": [1, 2]}], "poses": [{"name": "p"}],
        "stiffness": [{"image": "stiff.png", "max": 2}]})");
    Json json = info(folder / "lost.json");
    EXPECT_EQ(json["kind"], "puppet");
    EXPECT_EQ(json["handles"]["point"], 1);
    EXPECT_EQ(json["handle_ids"], Json::array({"a"}));
    EXPECT_EQ(json["poses"], Json::array({"p"}));
    EXPECT_EQ(json["stiffness"], 1);
    EXPECT_EQ(json["files"], Json::array({folder / "gone.png", folder / "stiff.png"}));
    EXPECT_EQ(json["width"], nullptr);
    EXPECT_THAT(json["error"].get<std::string>(), HasSubstr("gone.png: no such file"));

    put_bytes(folder / "wrong.json", R"({"format": "puppetwarp", "version": 1, "mesh": {"min_angle_deg": 60}})");
    EXPECT_THAT(info(folder / "wrong.json")["error"].get<std::string>(), HasSubstr("mesh.min_angle_deg"));
    put_bytes(folder / "other.json", R"({"name": "not ours"})");
    EXPECT_THAT(info(folder / "other.json")["error"].get<std::string>(), HasSubstr("`format`"));

    put_bytes(folder / "rig.json", R"({"format": "puppetwarp", "version": 1})");
    json = info(folder / "rig.json");
    EXPECT_EQ(json["sound"], true);  // a rig for meshes has no picture
    EXPECT_EQ(json["image"], nullptr);
    EXPECT_EQ(json["background"], "transparent");
}

TEST_F(Info, OfWhatIsNoneOfThese) {
    put_bytes(folder / "weights.csv", "a,b\n0.5,0.5\n");
    put_bytes(folder / "weights.DMAT", "1 1\n0.5\n");
    put_bytes(folder / "rig.puppet.weights", "whatever");
    put_bytes(folder / "drawing.svg", "<svg xmlns='http://www.w3.org/2000/svg'/>");
    put_bytes(folder / "text.txt", "Only words.\n");
    put_bytes(folder / "text", "Only words.\n");
    put_bytes(folder / "empty.png", "");
    const std::vector<std::pair<std::string, std::string>> cases{
        {"weights.csv", "is a table of numbers, which puppetwarp writes and does not read"},
        {"weights.DMAT", "is a table of numbers"},
        {"rig.puppet.weights", "keeps the weights of a puppet file"},
        {"drawing.svg", "is not a picture of a known format"},
        {"text.txt", "is not a picture of a known format"},
        {"text", "is not a picture of a known format"},
        {"empty.png", "the file is empty"},
        {"missing.png", "no such file"},
        {"folder.png", "is a folder"}};
    fs::create_directory(folder / "folder.png");
    for (const auto& [name, reason] : cases) {
        const Json json = info(folder / name);
        EXPECT_EQ(json["kind"], nullptr) << name;
        EXPECT_THAT(json["error"].get<std::string>(), HasSubstr(std::string(name).append(": ").append(reason)));
    }
}

TEST_F(Info, OfSeveralFilesIsAList) {
    write_image(noise_picture(90, 70, CV_8UC3), folder / "in.png");
    const CommandResult result = puppetwarp_command({"info", "--json", folder / "in.png", folder / "missing.png"});
    EXPECT_EQ(result.exit_code, 2);
    const Json json = Json::parse(result.output);
    ASSERT_EQ(json.size(), 2u);
    EXPECT_EQ(json[0]["sound"], true);
    EXPECT_EQ(json[1]["sound"], false);
    const CommandResult text = puppetwarp_command({"info", folder / "in.png", folder / "missing.png"});
    EXPECT_EQ(text.exit_code, 2);
    EXPECT_THAT(text.output, testing::StartsWith(folder / "in.png\n"));
    EXPECT_THAT(text.output, HasSubstr("\n  width              90\n"));
    EXPECT_THAT(text.errors, HasSubstr("missing.png: no such file"));
}

TEST_F(Info, HelpNamesEveryField) {
    const std::string help = puppetwarp_command({"info", "--help"}).output;
    put_bytes(folder / "mesh.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    for (const fs::path& file : {kSource / "images/gingerbread.png", fs::path(folder / "mesh.off"),
                                 kSource / "images/gingerbread.puppet.json"}) {
        const Json json = info(file);
        for (const auto& [key, value] : json.items()) {
            EXPECT_THAT(help, testing::ContainsRegex("[ \n]" + key + "[ ,;:]")) << key;
        }
    }
    const std::string page = puppetwarp_command({"man", "info"}).output;
    EXPECT_THAT(page, HasSubstr(".SH REPORT FIELDS\n"));
}

}  // namespace
}  // namespace puppetwarp::tests
