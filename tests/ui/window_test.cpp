#include "support/run_command.h"
#include "ui/driven_editor.h"

#include <puppetwarp/base/input_file.h>
#include <puppetwarp/image/read.h>
#include <puppetwarp/image/write.h>
#include <puppetwarp/project/pipeline.h>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include <cstdlib>
#include <cstring>
#include <memory>
#include <regex>
#include <set>
#include <tuple>

namespace puppetwarp::tests {
namespace {

namespace fs = std::filesystem;

const std::string program = PUPPETWARP_BINARY_DIR "/puppetwarp-ui";

// How far apart two pictures are at their worst pixel inside a rectangle.
double difference(const Image& a, const Image& b, const cv::Rect& where) {
    return cv::norm(a.pixels(where), b.pixels(where), cv::NORM_INF);
}

class WindowTest : public testing::Test {
protected:
    static void SetUpTestSuite() { display = std::make_unique<VirtualDisplay>(); }
    static void TearDownTestSuite() { display.reset(); }

    void SetUp() override { fs::copy_file(fs::path(PUPPETWARP_SOURCE_DIR) / "images" / "gingerbread.png", picture); }

    // Where the picture lies in a screenshot.
    cv::Rect picture_rect(const DrivenEditor& editor, const Image& image) const {
        const Point a = editor.window_from_image({0, 0});
        const Point b = editor.window_from_image(Point(image.width(), image.height()));
        return {cv::Point(cvRound(a.x()), cvRound(a.y())), cv::Point(cvRound(b.x()), cvRound(b.y()))};
    }

    static std::unique_ptr<VirtualDisplay> display;
    TemporaryFolder folder;
    const std::string picture = folder / "gingerbread.png";
};

std::unique_ptr<VirtualDisplay> WindowTest::display;

// Points of the gingerbread man: shares of the picture's size, all well inside the subject.
Point at(const Image& image, double x, double y) {
    // Whole screen pixels would not hit them exactly; a pin's place is checked to within one.
    return {image.width() * x, image.height() * y};
}

TEST_F(WindowTest, FromAPictureToASavedPuppetAndAnExportedPicture) {
    const Image image = read_image(picture);
    const Point belly = at(image, 0.5, 0.55);
    const Point head = at(image, 0.5, 0.2);
    const Point neck = at(image, 0.5, 0.4);
    const Point pulled = at(image, 0.62, 0.25);
    DrivenEditor editor(*display, folder.path(), {picture});
    editor.wait_for({"document=1", "settled=1", "pins=0", "modified=0"});
    const Image bare = editor.screenshot();
    const cv::Rect where = picture_rect(editor, image);
    cv::Scalar mean, deviation;
    cv::meanStdDev(bare.pixels(where), mean, deviation);
    EXPECT_GT(deviation[0], 5) << "the window shows no picture";

    int count = 0;
    for (const Point& place : {belly, neck, head}) {
        editor.click(place);
        editor.wait_for({"settled=1", "pins=" + std::to_string(++count), "trouble=0"});
    }
    editor.xdotool(editor.to_window({5, 400}));
    const Image before = editor.screenshot();

    std::vector<std::string> words = editor.to_image(head);
    words.insert(words.end(), {"mousedown", "1"});
    editor.xdotool(words);
    for (int i = 1; i <= 8; ++i) editor.xdotool(editor.to_image(head + (pulled - head) * i / 8));
    editor.wait_for({"dragging=1", "live=1", "undo=0"});
    const Image dragged = editor.screenshot();
    EXPECT_GT(difference(before, dragged, where), 50) << "the picture does not follow";
    editor.xdotool({"mouseup", "1"});
    editor.wait_for({"dragging=0", "live=0", "settled=1", "undo=1", "trouble=0"});
    editor.xdotool(editor.to_window({5, 400}));
    const Image after = editor.screenshot();

    editor.key("ctrl+z");
    editor.wait_for({"settled=1", "redo=1"});
    EXPECT_EQ(difference(before, editor.screenshot(), where), 0) << "undo does not bring the picture back";
    editor.key("ctrl+shift+z");
    editor.wait_for({"settled=1", "redo=0"});
    EXPECT_EQ(difference(after, editor.screenshot(), where), 0);

    editor.key("ctrl+s");
    editor.wait_for({"dialog=browser"});
    editor.key("Return");
    editor.wait_for({"dialog=none", "modified=0"});
    const Puppet puppet = read_puppet(folder / "gingerbread.puppet.json");
    ASSERT_EQ(puppet.rig.handles.size(), 3u);
    ASSERT_EQ(puppet.poses.size(), 1u);
    EXPECT_EQ(puppet.image, "gingerbread.png");
    const double pixel = 1.5 / std::stod(editor.state().at("scale"));
    EXPECT_LT((std::get<PointHandle>(puppet.rig.handles[0].shape).at - belly).norm(), pixel);
    EXPECT_LT((*puppet.poses[0].handles.at(puppet.rig.handles[2].id).to - pulled).norm(), 2 * pixel);

    editor.key("ctrl+e");
    editor.wait_for({"dialog=browser"});
    editor.key("Return");
    editor.wait_until("the export", [](const EditorState& state) {
        return state.at("exporting") == "0" && state.at("message").starts_with("Exported");
    });
    const Image exported = read_image(folder / "gingerbread-warped.png");
    Progress progress;
    const Image expected = render(puppet, default_pose(puppet), {}, progress).image;
    ASSERT_EQ(exported.pixels.size(), image.pixels.size());
    ASSERT_EQ(exported.pixels.type(), expected.pixels.type());
    EXPECT_EQ(cv::norm(exported.pixels, expected.pixels, cv::NORM_INF), 0);

    editor.key("ctrl+q");
    EXPECT_EQ(editor.wait_for_exit(), 0);
}

TEST_F(WindowTest, AsksAboutUnsavedChangesAndLosesNothingByACancel) {
    const Image image = read_image(picture);
    DrivenEditor editor(*display, folder.path(), {picture});
    editor.wait_for({"document=1", "settled=1"});
    editor.click(at(image, 0.5, 0.55));
    editor.wait_for({"pins=1", "modified=1", "settled=1"});
    editor.key("ctrl+q");
    editor.wait_for({"dialog=unsaved"});
    editor.key("Escape");
    editor.wait_for({"dialog=none", "pins=1", "modified=1"});
    editor.key("Delete");
    editor.wait_for({"pins=0", "settled=1"});
    editor.key("ctrl+z");
    editor.wait_for({"pins=1", "settled=1"});
    editor.key("ctrl+s");
    editor.wait_for({"dialog=browser"});
    editor.key("Return");
    editor.wait_for({"dialog=none", "modified=0"});
    editor.key("ctrl+q");
    EXPECT_EQ(editor.wait_for_exit(), 0);
}

TEST_F(WindowTest, SaysWhatIsWrongAndGoesOn) {
    put_bytes(folder / "broken.png", "no picture");
    DrivenEditor editor(*display, folder.path(), {folder / "broken.png"});
    editor.wait_for({"error=1", "document=0"});
    EXPECT_NE(editor.state().at("message").find("broken.png"), std::string::npos);
    editor.key("ctrl+o");
    editor.wait_for({"dialog=browser"});
    editor.xdotool({"type", "--delay", "20", picture});
    editor.key("Return");
    editor.wait_for({"dialog=none", "document=1", "settled=1"});
}

TEST_F(WindowTest, ADraggedPinSettlesAndIsSaved) {
    for (const std::string method : {"smooth-arap", "fold-free"}) {
        Puppet puppet = read_puppet(fs::path(PUPPETWARP_SOURCE_DIR) / "images" / "gingerbread.puppet.json");
        puppet.poses.clear();
        puppet.method.method = method_from_name(method);
        puppet.image = picture;
        const fs::path file = folder / (method + ".puppet.json");
        write_puppet(puppet, file);
        const Point hand = std::get<PointHandle>(find_handle(puppet.rig, "right hand")->shape).at;

        DrivenEditor editor(*display, folder.path(), {file});
        editor.wait_for({"document=1", "settled=1", "trouble=0", "method=" + method});
        std::vector<std::string> words = editor.to_image(hand);
        words.insert(words.end(), {"mousedown", "1"});
        editor.xdotool(words);
        for (int i = 1; i <= 8; ++i) editor.xdotool(editor.to_image(hand + Point(-50, -35) * i));
        // The button is held still: the picture goes on until it has settled.
        editor.wait_for({"dragging=1", "live=1", "resting=1", "trouble=0"});
        editor.xdotool({"mouseup", "1"});
        editor.wait_for({"dragging=0", "live=0", "settled=1", "undo=1", "trouble=0"});
        editor.key("ctrl+s");
        editor.wait_for({"modified=0"});
        const Puppet saved = read_puppet(file);
        // Where it settles to the pixel, held and let go, is the model's to test: DragTest.
        EXPECT_TRUE(saved.poses.at(0).handles.at("right hand").to) << method;
        editor.key("ctrl+q");
        EXPECT_EQ(editor.wait_for_exit(), 0);
    }
}

// A page whose right half is folded over its left: its back is blue, what lies under it red.
TEST_F(WindowTest, ShowsWhatIsInFrontAsTheCommandDraws) {
    Image page{cv::Mat(140, 140, CV_8UC3, cv::Scalar(220, 20, 20)), {}};
    page.pixels.colRange(70, 140).setTo(cv::Scalar(20, 20, 220));
    write_image(page, folder / "page.png");
    const Point under(30, 70);
    for (const auto& [depth, back_faces, blue] :
         {std::tuple("1", "show", true), {"-1", "show", false}, {"1", "hide", false}}) {
        const std::string file = folder / "page.puppet.json";
        put_bytes(file, R"({"format": "puppetwarp", "version": 1, "image": "page.png", "back_faces": ")" +
                            std::string(back_faces) + R"(", "method": {"name": "harmonic"}, "handles": [
            {"id": "left", "type": "region", "points": [[-9, -9], [40, -9], [40, 149], [-9, 149]]},
            {"id": "right", "type": "region", "points": [[100, -9], [149, -9], [149, 149], [100, 149]]}],
            "poses": [{"name": "folded", "handles": {"right": {"affine": [-1, 0, 0, 1, 140, 0], "depth": )" +
                            depth + "}}}]}");
        const Puppet puppet = read_puppet(file);
        Progress progress;
        const cv::Mat drawn = render(puppet, default_pose(puppet), {}, progress).image.pixels;
        EXPECT_EQ(drawn.at<cv::Vec4b>(70, 30), blue ? cv::Vec4b(20, 20, 220, 255) : cv::Vec4b(220, 20, 20, 255));
        DrivenEditor editor(*display, folder.path(), {file});
        editor.wait_for({"document=1", "settled=1"});
        const Image shown = editor.screenshot();
        const Point place = editor.window_from_image(under);
        const auto pixel = shown.pixels.at<cv::Vec3b>(cvRound(place.y()), cvRound(place.x()));
        EXPECT_EQ(pixel, blue ? cv::Vec3b(20, 20, 220) : cv::Vec3b(220, 20, 20)) << depth << " " << back_faces;
    }
}

// A red square on grey, moved away: what is left behind is filled.
TEST_F(WindowTest, ShowsTheFilledBackground) {
    Image square{cv::Mat(140, 140, CV_8UC3, cv::Scalar(90, 100, 110)), {}};
    square.pixels(cv::Rect(20, 50, 40, 40)).setTo(cv::Scalar(220, 20, 20));
    write_image(square, folder / "square.png");
    const std::string file = folder / "square.puppet.json";
    put_bytes(file, R"({"format": "puppetwarp", "version": 1, "image": "square.png", "background": "inpaint",
        "cutout": {"from": "polygon", "points": [[20, 50], [60, 50], [60, 90], [20, 90]]},
        "handles": [{"id": "a", "type": "point", "at": [40, 70]}],
        "poses": [{"name": "moved", "handles": {"a": {"to": [100, 70], "rotate_deg": 0}}}]})");
    DrivenEditor editor(*display, folder.path(), {file});
    editor.wait_for({"document=1", "settled=1", "trouble=0"});
    const Image shown = editor.screenshot();
    const auto at = [&](double x, double y) {
        const Point place = editor.window_from_image({x, y});
        return shown.pixels.at<cv::Vec3b>(cvRound(place.y()), cvRound(place.x()));
    };
    EXPECT_EQ(at(85, 60), cv::Vec3b(220, 20, 20));
    EXPECT_EQ(at(40, 70), cv::Vec3b(90, 100, 110));
}

TEST_F(WindowTest, AClickWithinOneFrameIsNotLost) {
    const Image image = read_image(picture);
    DrivenEditor editor(*display, folder.path(), {picture});
    editor.wait_for({"document=1", "settled=1"});
    // Press, release, move away and press again at once: each counts at its own place.
    std::vector<std::string> words = editor.to_image(at(image, 0.5, 0.55));
    words.insert(words.end(), {"click", "--delay", "0", "1"});
    for (const std::string& word : editor.to_image(at(image, 0.5, 0.2))) words.push_back(word);
    words.insert(words.end(), {"click", "--delay", "0", "1"});
    for (const std::string& word : editor.to_window({5, 400})) words.push_back(word);
    editor.xdotool(words);
    editor.wait_for({"pins=2", "settled=1"});
}

TEST(ProgramTest, HelpAndVersionNeedNoDisplay) {
    const auto no_display = [] {
        unsetenv("DISPLAY");
        unsetenv("WAYLAND_DISPLAY");
    };
    const CommandResult help = run_command({program, "--help"}, no_display);
    EXPECT_EQ(help.exit_code, 0);
    EXPECT_NE(help.output.find("Usage: puppetwarp-ui"), std::string::npos);
    const CommandResult version = run_command({program, "--version"}, no_display);
    EXPECT_EQ(version.exit_code, 0);
    EXPECT_TRUE(version.output.starts_with("puppetwarp-ui "));
    const CommandResult unknown = run_command({program, "--wobble"}, no_display);
    EXPECT_EQ(unknown.exit_code, 2);
    EXPECT_NE(unknown.errors.find("--wobble"), std::string::npos);
}

std::set<std::string> matches(const std::string& text, const char* pattern) {
    const std::regex expression(pattern);
    std::set<std::string> found;
    for (std::sregex_iterator each(text.begin(), text.end(), expression), end; each != end; ++each) {
        found.insert((*each)[1]);
    }
    return found;
}

TEST(ProgramTest, TheManualPageSaysWhatTheHelpSays) {
    const std::string help = run_command({program, "--help"}).output;
    const std::string file = PUPPETWARP_BINARY_DIR "/ui/puppetwarp-ui.1";
    std::string page = read_file(file, 100'000);
    for (const char* font : {"\\fB", "\\fI", "\\fR", "\\"}) {
        for (std::size_t at = 0; (at = page.find(font)) != std::string::npos;) page.erase(at, std::strlen(font));
    }
    const std::set<std::string> options = matches(help, "(--?[a-z]+)\\b");
    EXPECT_EQ(options, (std::set<std::string>{"-h", "--help", "--version", "-ui"}));
    EXPECT_EQ(matches(page, "(--?[a-z]+)\\b"), options);
    for (const char* said : {"puppetwarp-ui [IMAGE|PUPPET]", "\nIMAGE\n", "\nPUPPET\n", "puppetwarp-ui photo.jpg"}) {
        EXPECT_NE(page.find(said), std::string::npos) << said;
    }
    const CommandResult groff = run_command({"/usr/bin/groff", "-man", "-ww", "-z", file});
    EXPECT_EQ(groff.exit_code, 0);
    EXPECT_EQ(groff.errors, "");
    EXPECT_EQ(page.find('@'), std::string::npos);
}

TEST(ProgramTest, WithoutADisplayItSaysSoInOneLine) {
    const CommandResult result = run_command({program}, [] {
        unsetenv("DISPLAY");
        unsetenv("WAYLAND_DISPLAY");
    });
    EXPECT_EQ(result.exit_code, 3);
    EXPECT_EQ(result.output, "");
    EXPECT_TRUE(result.errors.starts_with("puppetwarp-ui: "));
    EXPECT_EQ(result.errors.find('\n'), result.errors.size() - 1);
}

}  // namespace
}  // namespace puppetwarp::tests
