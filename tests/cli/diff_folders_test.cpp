// `puppetwarp diff` of folders from outside: which pictures meet, what is named, pages and pictures of many pairs.

#include "diff_pictures.h"

#include <puppetwarp/image/read.h>

#include <filesystem>

#include <sys/stat.h>
#include <unistd.h>

namespace puppetwarp::tests {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;

class DiffFolders : public Diff {
protected:
    DiffFolders() {
        for (const char* side : {"exp", "act"}) fs::create_directories(folder / (std::string(side) + "/sub"));
        put("exp/same.png", a);
        put("act/same.png", a);
        put("exp/sub/other.png", a);
        put("act/sub/other.png", b);
    }
    void put(const std::string& path, const std::string& from) const { fs::copy_file(from, folder / path); }
    CommandResult folders(std::vector<std::string> more = {}) const {
        return diff(std::move(more), folder / "exp", folder / "act");
    }
};

TEST_F(DiffFolders, PicturesOfTheSamePathCompare) {
    const CommandResult result = folders();
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_EQ(result.errors, "");
    EXPECT_THAT(result.output, StartsWith("different: sub/other.png: 6 pixels differ (0.25 %)"));
    EXPECT_THAT(result.output, HasSubstr("\ndifferent: 1 of 2 pictures are the same, 1 different\n"));
    EXPECT_EQ(folders({"--threshold", "8/255"}).output, "same: 2 of 2 pictures are the same\n");
    EXPECT_EQ(folders({"--threshold", "8/255"}).exit_code, 0);
    EXPECT_EQ(folders({"-q"}).output, "");
}

TEST_F(DiffFolders, MissingAndExtraPicturesAreNamedAndOtherFilesPassedOver) {
    put("exp/gone.png", a);
    put("act/sub/new.png", a);
    put_bytes(folder / "exp/notes.txt", "of no account");
    const CommandResult result = folders({"--threshold", "8/255"});
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_EQ(result.output,
              "missing: gone.png\nextra: sub/new.png\n"
              "different: 2 of 4 pictures are the same, 1 missing, 1 extra\n");
    const Json json = report({}, folder / "exp", folder / "act");
    EXPECT_EQ(json["same"], false);
    EXPECT_EQ(json["pairs"], 4);
    EXPECT_THAT(json["missing"], ElementsAre("gone.png"));
    EXPECT_THAT(json["extra"], ElementsAre("sub/new.png"));
    EXPECT_EQ(json["results"][3]["path"], "sub/other.png");
    EXPECT_EQ(json["results"][3]["differing_pixels"], 6);
}

TEST_F(DiffFolders, AFileThatCannotBeReadIsNamedAndTheOthersAreCompared) {
    put_bytes(folder / "exp/broken.png", "no picture");
    put("act/broken.png", a);
    put("exp/link.png", a);
    fs::create_symlink("nowhere.png", folder / "act/link.png");
    const CommandResult result = folders();
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.errors, HasSubstr("exp/broken.png: is not a picture"));
    EXPECT_THAT(result.errors, HasSubstr("act/link.png"));
    EXPECT_EQ(std::count(result.errors.begin(), result.errors.end(), '\n'), 2);
    EXPECT_THAT(result.output, HasSubstr("different: sub/other.png"));
    EXPECT_THAT(result.output, HasSubstr("2 not compared\n"));
}

TEST_F(DiffFolders, PicturesOfFormatsThatCannotBeReadDoNotPassUnseen) {
    for (const char* name : {"a.bmp", "b.TGA", "c.jxl"}) {
        put_bytes(folder / "exp/" + name, "BM one");
        put_bytes(folder / "act/" + name, "BM two");
    }
    const CommandResult result = folders({"--threshold", "8/255"});
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.errors, HasSubstr("exp/b.TGA: is not a picture of a known format"));
    EXPECT_THAT(result.output, HasSubstr("3 not compared"));
}

TEST_F(DiffFolders, APairThatTheOptionsDoNotSuitIsNamed) {
    write_image(noise_picture(20, 20, CV_8UC3), folder / "exp/small.png");
    put("act/small.png", folder / "exp/small.png");
    const CommandResult result = folders({"--ignore", "30,30,5,5"});
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.errors, StartsWith("puppetwarp: small.png: ignore 30,30,5,5: lies outside of the picture"));
    EXPECT_THAT(result.output, HasSubstr("1 not compared\n"));
}

TEST_F(DiffFolders, LinksThatLeadRoundAreNotFollowed) {
    fs::create_directory_symlink("..", folder / "exp/sub/up");
    fs::create_directory_symlink("sub", folder / "act/again");
    const CommandResult result = folders({"--threshold", "8/255"});
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_THAT(result.errors, HasSubstr("sub/up: leads to a folder that it lies in"));
    EXPECT_THAT(result.output, HasSubstr("extra: again/other.png"));
}

TEST_F(DiffFolders, AFolderAgainstAFileOrWithoutPictures) {
    expect_refused(diff({}, folder / "exp", a), "two pictures or two folders");
    expect_refused(diff({}, a, folder / "exp"), "two pictures or two folders");
    expect_refused(diff({}, folder / "exp", folder / "missing"), folder / "missing" + ": no such folder");
    expect_refused(diff({}, folder / "missing", folder / "exp"), folder / "missing" + ": no such folder");
    fs::create_directory(folder / "empty1");
    fs::create_directory(folder / "empty2");
    expect_refused(diff({}, folder / "empty1", folder / "empty2"), "neither this folder nor");
    EXPECT_EQ(diff({}, folder / "exp", folder / "empty1").exit_code, 1);
}

TEST_F(DiffFolders, PicturesOfWhatDiffersGoIntoFolders) {
    ASSERT_EQ(folders({"--heatmap", folder / "out", "--side-by-side", folder / "out"}).exit_code, 1);
    EXPECT_TRUE(fs::exists(folder / "out/sub/other.png.heatmap.png"));
    EXPECT_TRUE(fs::exists(folder / "out/sub/other.png.side-by-side.png"));
    EXPECT_FALSE(fs::exists(folder / "out/same.png.heatmap.png"));
    expect_refused(folders({"--heatmap", folder / "act/out"}), "choose a folder outside");
    expect_refused(folders({"--heatmap", a}), "is not a folder");
    expect_refused(folders({"--heatmap", "-"}), "is not a folder");
}

TEST_F(DiffFolders, PicturesOfLongNamesThatBeginAlikeAreAllWritten) {
    std::string letters;
    for (int i = 0; i < 121; ++i) letters += "\u00f6";  // two bytes each
    const std::vector<std::string> names{letters + "-one.png", letters + "-two.png"};
    for (const std::string& name : names) {
        put("exp/" + name, a);
        put("act/" + name, b);
    }
    const CommandResult result = folders({"--heatmap", folder / "out"});
    EXPECT_EQ(result.exit_code, 1) << result.errors;
    std::vector<std::string> written;
    for (const auto& entry : fs::directory_iterator(folder / "out")) {
        if (entry.is_regular_file()) written.push_back(entry.path().filename().string());
    }
    ASSERT_EQ(written.size(), 2U);
    for (const std::string& name : written) {
        EXPECT_THAT(name, testing::EndsWith(".heatmap.png"));
        EXPECT_EQ(name.substr(0, name.find('~')), letters.substr(0, name.find('~'))) << "cut within a letter";
        EXPECT_EQ(name.find('~') % 2, 0U);
    }
}

TEST_F(DiffFolders, TheReportIsTheSameForAnyNumberOfThreads) {
    for (int i = 0; i < 20; ++i) {
        const std::string name = "/many" + std::to_string(i) + ".png";
        put("exp" + name, a);
        if (i % 5 == 4) {
            put_bytes(folder / ("act" + name), i % 2 ? "no picture" : bytes_of(b).substr(0, 300));
        } else {
            put("act" + name, i % 3 == 0 ? b : a);
        }
    }
    std::vector<std::string> outputs;
    std::vector<std::string> pages;
    for (const char* threads : {"1", "2", "8"}) {
        const CommandResult result = folders({"-j", threads, "--json", "--html", folder / "page.html"});
        EXPECT_EQ(result.exit_code, 2);
        outputs.push_back(result.output + result.errors);
        pages.push_back(bytes_of(folder / "page.html"));
    }
    EXPECT_EQ(outputs[0], outputs[1]);
    EXPECT_EQ(outputs[0], outputs[2]);
    EXPECT_EQ(pages[0], pages[1]);
    EXPECT_EQ(pages[0], pages[2]);
}

TEST_F(DiffFolders, ThePageHoldsHostileNamesAsText) {
    // Slashes in tags make folders.
    const std::string path = "/</td><script>alert(1)<";
    fs::create_directories(folder / ("exp" + path));
    fs::create_directories(folder / ("act" + path));
    put("exp" + path + "/script>{{rows}}\n\xff\"'&.png", a);
    put("act" + path + "/script>{{rows}}\n\xff\"'&.png", b);
    const CommandResult result = folders({"--html", folder / "page.html"});
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_THAT(result.output, HasSubstr("script>{{rows}}\\x0a\\xff\"'&.png"));
    const std::string page = bytes_of(folder / "page.html");
    EXPECT_NE(page.find("&lt;script&gt;alert(1)&lt;/script&gt;{{rows}}\\x0a\\xff&quot;&#39;&amp;.png"),
              std::string::npos);
    EXPECT_EQ(page.find("<script>alert"), std::string::npos);
    EXPECT_EQ(page.find("://"), std::string::npos);  // nothing comes from elsewhere
    EXPECT_NE(page.find("default-src 'none'"), std::string::npos);
}

TEST_F(DiffFolders, APageOfTwoPictures) {
    ASSERT_EQ(diff({"--html", folder / "page.html"}, a, b).exit_code, 1);
    const std::string page = bytes_of(folder / "page.html");
    EXPECT_EQ(page.find("<!doctype html>"), 0);
    for (const char* kind : {"expected", "actual", "heat"}) {
        EXPECT_NE(page.find(std::string("\"") + kind + "\":\"iVBORw0KGgo"), std::string::npos) << kind;
    }
    EXPECT_EQ(page.find("{{"), std::string::npos);
    ASSERT_EQ(diff({"--html", folder / "same.html"}, a, a).exit_code, 0);
    EXPECT_NE(bytes_of(folder / "same.html").find("<span class=\"same\">same</span>"), std::string::npos);
}

}  // namespace
}  // namespace puppetwarp::tests
