#include "support/run_command.h"
#include "ui/driven_model.h"

#include <puppetwarp/image/read.h>
#include <puppetwarp/image/write.h>
#include <puppetwarp/project/pipeline.h>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

namespace puppetwarp::ui {
namespace {

using tests::TemporaryFolder;

// The editor on a picture of stripes.
class EditorTest : public DrivenModel {
protected:
    void SetUp() override {
        Image stripes;
        stripes.pixels = cv::Mat(90, 120, CV_8UC3);
        for (int y = 0; y < 90; ++y)
            for (int x = 0; x < 120; ++x)
                stripes.pixels.at<cv::Vec3b>(y, x) = cv::Vec3b(static_cast<std::uint8_t>(x * 2),
                                                               static_cast<std::uint8_t>(y * 2), x / 10 % 2 ? 200 : 30);
        write_image(stripes, picture);
    }

    Rendered rendered(const Puppet& puppet, const Pose& pose) const {
        Progress progress;
        return render(puppet, pose, {}, progress);
    }

    TemporaryFolder folder;
    const std::string picture = folder / "stripes.png";
};

TEST_F(EditorTest, APictureOpensWithATriangulationAndNothingToSave) {
    open(picture);
    ASSERT_TRUE(editor.has_document());
    settle();
    EXPECT_EQ(editor.shape()->subject->image.width(), 120);
    EXPECT_GT(editor.shape()->mesh->F.rows(), 0);
    EXPECT_EQ(editor.shape()->moved, editor.shape()->mesh->V);
    EXPECT_EQ(editor.shape()->error, "");
    EXPECT_FALSE(editor.modified());
    EXPECT_EQ(editor.document_name(), "stripes.png");
}

TEST_F(EditorTest, SettingAPinMovesNothing) {
    open(picture);
    click({20, 20});
    click({100, 70});
    EXPECT_EQ(editor.shape()->error, "");
    drag({100, 70}, {110, 60});
    settle();
    const Eigen::MatrixX2d before = editor.shape()->moved;
    click({60, 40});  // on the moved picture
    EXPECT_LT((editor.shape()->moved - before).cwiseAbs().maxCoeff(), 0.5);
    const auto list = pins(editor.puppet(), editor.pose());
    ASSERT_EQ(list.size(), 3u);
    EXPECT_EQ(list[2].to, Point(60, 40));
}

TEST_F(EditorTest, WhatIsShownAtRestIsWhatTheCommandRenders) {
    open(picture);
    for (const Point& at : {Point(20, 20), Point(100, 70), Point(20, 70)}) click(at);
    drag({100, 70}, {80, 40});
    settle();
    for (const Method method : {Method::harmonic, Method::biharmonic, Method::arap}) {
        editor.set_method(method);
        settle();
        ASSERT_EQ(editor.shape()->error, "");
        const std::string file = folder / (method_name(method) + ".puppet.json");
        ASSERT_TRUE(editor.save_as(file));
        const Puppet saved = read_puppet(file);
        const Rendered result = rendered(saved, default_pose(saved));
        EXPECT_EQ(result.moved, editor.shape()->moved) << method_name(method);
        EXPECT_EQ(result.mesh.F, editor.shape()->mesh->F);
    }
}

TEST_F(EditorTest, ADragIsOneStepAndComesBack) {
    open(picture);
    click({20, 20});
    click({100, 70});
    const Eigen::MatrixX2d before = editor.shape()->moved;
    drag({100, 70}, {90, 50});
    settle();
    const Eigen::MatrixX2d after = editor.shape()->moved;
    EXPECT_GT((after - before).cwiseAbs().maxCoeff(), 5);
    editor.undo();
    settle();
    EXPECT_EQ(editor.shape()->moved, before);
    editor.redo();
    settle();
    EXPECT_EQ(editor.shape()->moved, after);
}

TEST_F(EditorTest, WhileAPinIsDraggedThePictureFollows) {
    open(picture);
    click({20, 20});
    click({100, 70});
    const Eigen::MatrixX2d before = editor.shape()->moved;
    editor.press({100, 70}, image_px_per_point);
    editor.move({80, 60});
    follow();
    EXPECT_TRUE(editor.shape()->live);
    EXPECT_GT((editor.shape()->moved - before).cwiseAbs().maxCoeff(), 5);
    EXPECT_FALSE(editor.can_undo());
    editor.cancel();
    settle();
    EXPECT_EQ(editor.shape()->moved, before);
    EXPECT_EQ(pins(editor.puppet(), editor.pose())[1].to, Point(100, 70));
}

TEST_F(EditorTest, SavedAndOpenedAgainItIsTheSame) {
    open(picture);
    click({20, 20});
    click({100, 70});
    drag({100, 70}, {90, 50});
    settle();
    const auto moved = editor.shape()->moved;
    EXPECT_TRUE(editor.modified());
    const std::string file = folder / "stripes.puppet.json";
    ASSERT_TRUE(editor.save_as(file));
    EXPECT_FALSE(editor.modified());
    EXPECT_EQ(read_puppet(file).image, "stripes.png") << "beside the file, without a folder";
    open(file);
    settle();
    EXPECT_EQ(editor.document_name(), "stripes.puppet.json");
    EXPECT_EQ(editor.shape()->moved, moved);
    EXPECT_FALSE(editor.modified());
    EXPECT_FALSE(editor.can_undo());
}

TEST_F(EditorTest, TheExportIsWhatTheLibraryRenders) {
    open(picture);
    click({20, 20});
    click({100, 70});
    drag({100, 70}, {90, 50});
    const std::string file = folder / "out.png";
    editor.export_picture(file);
    EXPECT_TRUE(editor.exporting());
    run_until([this] { return !editor.exporting(); });
    EXPECT_EQ(editor.message().kind, Message::Kind::info) << editor.message().text;
    const Image expected = rendered(editor.puppet(), editor.pose()).image;
    const Image actual = read_image(file);
    ASSERT_EQ(actual.pixels.type(), expected.pixels.type());
    EXPECT_EQ(cv::norm(actual.pixels, expected.pixels, cv::NORM_INF), 0);
}

TEST_F(EditorTest, WhatCannotBeOpenedLeavesWhatIsOpen) {
    open(picture);
    click({20, 20});
    tests::put_bytes(folder / "broken.png", "this is no picture");
    tests::put_bytes(folder / "broken.puppet.json", "{");
    tests::put_bytes(folder / "lost.puppet.json", R"({"format": "puppetwarp", "version": 1, "image": "no.png"})");
    for (const char* name : {"broken.png", "missing.png", "broken.puppet.json", "lost.puppet.json"}) {
        open(folder / name);
        EXPECT_EQ(editor.message().kind, Message::Kind::error) << name;
        EXPECT_EQ(editor.message().text.find('\n'), std::string::npos);
        EXPECT_EQ(editor.document_name(), "stripes.png");
        EXPECT_EQ(editor.puppet().rig.handles.size(), 1u);
        settle();
        EXPECT_TRUE(editor.shape()->subject);
        EXPECT_TRUE(editor.can_undo());
    }
    click({100, 70});
    EXPECT_EQ(editor.puppet().rig.handles.size(), 2u);
}

TEST_F(EditorTest, WhatCannotBeSavedStaysUnsaved) {
    open(picture);
    click({20, 20});
    EXPECT_FALSE(editor.save_as(folder / "missing/x.puppet.json"));
    EXPECT_EQ(editor.message().kind, Message::Kind::error);
    EXPECT_TRUE(editor.modified());
    EXPECT_TRUE(editor.file().empty());
    editor.export_picture(folder / "missing/x.png");
    run_until([this] { return !editor.exporting(); });
    EXPECT_EQ(editor.message().kind, Message::Kind::error);
}

TEST_F(EditorTest, ThePictureItselfIsNeverWrittenOver) {
    open(picture);
    click({20, 20});
    const std::string before = tests::bytes_of(picture);
    editor.export_picture(picture);
    run_until([this] { return !editor.exporting(); });
    EXPECT_EQ(editor.message().kind, Message::Kind::error);
    EXPECT_FALSE(editor.save_as(picture));
    EXPECT_EQ(tests::bytes_of(picture), before);
}

TEST_F(EditorTest, APinOutsideTheSubjectIsAnErrorLineAndThePictureStays) {
    const std::string file = folder / "outside.puppet.json";
    tests::put_bytes(file, R"({"format": "puppetwarp", "version": 1, "image": "stripes.png",
        "handles": [{"id": "far", "type": "point", "at": [900, 900]}]})");
    open(file);
    settle();
    EXPECT_NE(editor.shape()->error.find("far"), std::string::npos) << editor.shape()->error;
    EXPECT_TRUE(editor.shape()->subject);
    EXPECT_GT(editor.shape()->mesh->F.rows(), 0);
    editor.remove_pin("far");
    settle();
    EXPECT_EQ(editor.shape()->error, "");
}

TEST_F(EditorTest, TheChosenPoseIsShownAndEdited) {
    const std::string file = folder / "poses.puppet.json";
    tests::put_bytes(file, R"({"format": "puppetwarp", "version": 1, "image": "stripes.png",
        "handles": [{"id": "a", "type": "point", "at": [20, 20]}, {"id": "b", "type": "point", "at": [100, 70]}],
        "poses": [{"name": "one", "time_s": 0, "handles": {"b": {"to": [90, 60]}}},
                  {"name": "two", "time_s": 1, "handles": {"b": {"to": [100, 40]}}}]})");
    open(file);
    EXPECT_EQ(editor.pose_name(), "one");
    settle();
    const auto one = editor.shape()->moved;
    editor.choose_pose("two");
    settle();
    EXPECT_NE(editor.shape()->moved, one);
    EXPECT_FALSE(editor.modified()) << "looking at a pose is no change";
    drag({100, 40}, {100, 50});
    settle();
    EXPECT_EQ(*find_pose(editor.puppet(), "two").handles.at("b").to, Point(100, 50));
    EXPECT_EQ(*find_pose(editor.puppet(), "one").handles.at("b").to, Point(90, 60));
    editor.clear_pose();
    settle();
    EXPECT_LT((editor.shape()->moved - editor.shape()->mesh->V).cwiseAbs().maxCoeff(), 1e-6);
}

}  // namespace
}  // namespace puppetwarp::ui
