#include "support/run_command.h"

#include <puppetwarp/base/errors.h>
#include <puppetwarp/image/write.h>
#include <puppetwarp/project/pipeline.h>
#include <puppetwarp/project/stiffness_pictures.h>

#include <opencv2/core.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <set>
#include <thread>

namespace puppetwarp {
namespace {

class Pipeline : public testing::Test {
protected:
    // A square of 100 x 100 with a hole of `hole` x `hole` in its middle, in a picture of 140 x 140.
    Image square(int hole) {
        Image image;
        image.pixels = cv::Mat(140, 140, CV_8UC4, cv::Scalar(0, 0, 0, 0));
        image.pixels(cv::Rect(20, 20, 100, 100)).setTo(cv::Scalar(200, 100, 50, 255));
        image.pixels(cv::Rect(70 - hole / 2, 70 - hole / 2, hole, hole)).setTo(cv::Scalar(0, 0, 0, 0));
        return image;
    }

    Puppet puppet_of(const Image& image) {
        write_image(image, folder / "picture.png");
        Puppet puppet;
        puppet.folder = folder.path();
        puppet.image = "picture.png";
        puppet.rig.handles = {{"a", PointHandle{{40, 40}, {}}}, {"b", PointHandle{{100, 100}, {}}}};
        return puppet;
    }

    tests::TemporaryFolder folder;
    Progress progress;
};

TEST_F(Pipeline, HolesSmallerThanATriangleAreFilled) {
    Puppet puppet = puppet_of(square(10));
    const Image image = load_image(puppet);
    const Cutout cutout = cut_out_subject(puppet, image);
    puppet.mesh.max_edge_px = 5;
    EXPECT_EQ(outline_subject(puppet, 140, 140, cutout).components.at(0).holes.size(), 1u);
    puppet.mesh.max_edge_px = 40;
    EXPECT_EQ(outline_subject(puppet, 140, 140, cutout).components.at(0).holes.size(), 0u);
}

TEST_F(Pipeline, BonesBecomeEdgesOfTheMesh) {
    Puppet puppet = puppet_of(square(0));
    puppet.rig.handles = {{"bone", BoneHandle{{45, 45}, {95, 90}, ""}}};
    const TriangleMesh mesh = mesh_subject(puppet, rectangle_outline(140, 140));
    // Walk from one end along edges that lie on the bone.
    const Point from(45, 45), to(95, 90), direction = (to - from).normalized();
    std::set<std::pair<double, double>> covered;
    double length = 0;
    for (Eigen::Index t = 0; t < mesh.F.rows(); ++t) {
        for (int k = 0; k < 3; ++k) {
            const Point p = mesh.V.row(mesh.F(t, k)), q = mesh.V.row(mesh.F(t, (k + 1) % 3));
            const auto off = [&](const Point& r) {
                return std::abs((r - from).x() * direction.y() - (r - from).y() * direction.x());
            };
            if (off(p) > 1e-9 || off(q) > 1e-9) continue;
            const double s = (p - from).dot(direction), e = (q - from).dot(direction);
            if (std::min(s, e) < -1e-9 || std::max(s, e) > (to - from).norm() + 1e-9 || s > e) continue;
            length += e - s;
        }
    }
    EXPECT_NEAR(length, (to - from).norm(), 1e-6);
}

TEST_F(Pipeline, RestGivesThePictureBackThroughEveryFormatChoice) {
    const Image image = square(20);
    const Puppet puppet = puppet_of(image);
    const Rendered rendered = render(puppet, find_pose(puppet, "rest"), {}, progress);
    cv::Mat alpha_in, alpha_out;
    cv::extractChannel(image.pixels, alpha_in, 3);
    cv::extractChannel(rendered.image.pixels, alpha_out, 3);
    EXPECT_EQ(cv::norm(alpha_in, alpha_out, cv::NORM_INF), 0);
    EXPECT_TRUE(rendered.report.lost.empty());

    RenderOptions jpeg;
    jpeg.format = "jpeg";
    const Rendered flat = render(puppet, find_pose(puppet, "rest"), jpeg, progress);
    EXPECT_EQ(flat.image.pixels.at<cv::Vec4b>(2, 2), cv::Vec4b(255, 255, 255, 255));  // cut out: white
    EXPECT_EQ(flat.image.pixels.at<cv::Vec4b>(40, 40), cv::Vec4b(200, 100, 50, 255));
    EXPECT_THAT(flat.report.lost, testing::Contains(testing::HasSubstr("alpha")));
}

TEST_F(Pipeline, WholePictureInAFormatWithoutAlphaKeepsWhatIsBehind) {
    Image image;
    image.pixels = cv::Mat(60, 80, CV_8UC3, cv::Scalar(10, 20, 30));
    image.pixels.colRange(0, 5).setTo(cv::Scalar(90, 80, 70));
    Puppet puppet = puppet_of(image);
    puppet.rig.handles = {{"a", PointHandle{{40, 30}, {}}}};
    Pose pose;
    pose.handles["a"].to = Point(50, 30);
    RenderOptions jpeg;
    jpeg.format = "jpeg";
    const Rendered rendered = render(puppet, pose, jpeg, progress);
    ASSERT_EQ(rendered.image.pixels.channels(), 3);
    EXPECT_EQ(rendered.image.pixels.at<cv::Vec3b>(30, 2), cv::Vec3b(90, 80, 70));   // behind
    EXPECT_EQ(rendered.image.pixels.at<cv::Vec3b>(30, 12), cv::Vec3b(90, 80, 70));  // moved
}

TEST_F(Pipeline, GrownCanvasHoldsAllOfTheSubject) {
    const Puppet puppet = puppet_of(square(0));
    Pose pose;
    pose.handles["a"].to = Point(-60, 40);
    pose.handles["b"].to = Point(0, 100);
    RenderOptions options;
    options.canvas.kind = CanvasChoice::Kind::grow;
    const Rendered rendered = render(puppet, pose, options, progress);
    EXPECT_LE(rendered.report.canvas.x, -80);
    EXPECT_EQ(rendered.image.width(), rendered.report.canvas.width);
    cv::Mat alpha;
    cv::extractChannel(rendered.image.pixels, alpha, 3);
    EXPECT_NEAR(cv::countNonZero(alpha == 255), 100 * 100, 400);
}

// Two bars, one moved onto the other: the pose says which is in front.
TEST_F(Pipeline, DepthsDecideWhatIsInFront) {
    Image bars = square(0);
    bars.pixels.rowRange(60, 80).setTo(cv::Scalar(0, 0, 0, 0));
    bars.pixels(cv::Rect(20, 80, 100, 40)).setTo(cv::Scalar(10, 220, 30, 255));
    Puppet puppet = puppet_of(bars);
    Pose pose;
    pose.handles["b"].to = Point(100, 60);
    pose.handles["a"].rotate_rad = pose.handles["b"].rotate_rad = 0;
    const auto shared = [&] { return render(puppet, pose, {}, progress).image.pixels.at<cv::Vec4b>(50, 70); };
    pose.handles["b"].depth = 1;
    EXPECT_EQ(shared(), cv::Vec4b(10, 220, 30, 255));
    pose.handles["b"].depth = -1;
    EXPECT_EQ(shared(), cv::Vec4b(200, 100, 50, 255));
    pose.handles["a"].depth = -2;
    EXPECT_EQ(shared(), cv::Vec4b(10, 220, 30, 255));
    EXPECT_EQ(render(puppet, pose, {}, progress).depth.minCoeff(), -2);
}

// A red square on stripes, cut out by a polygon and moved: stripes are behind it.
TEST_F(Pipeline, InpaintFillsWhereTheSubjectWas) {
    Image image;
    image.pixels = cv::Mat(160, 200, CV_8UC3, cv::Scalar(40, 90, 60));
    for (int x = 0; x < 200; x += 20) image.pixels.colRange(x, x + 10).setTo(cv::Scalar(90, 160, 190));
    const cv::Mat empty = image.pixels.clone();
    image.pixels(cv::Rect(80, 60, 40, 40)).setTo(cv::Scalar(255, 0, 0));
    Puppet puppet = puppet_of(image);
    puppet.cutout.from = "polygon";
    puppet.cutout.points = {{80, 60}, {120, 60}, {120, 100}, {80, 100}};
    puppet.rig.handles = {{"a", PointHandle{{100, 80}, {}}}};
    puppet.background = "inpaint";
    Pose pose;
    pose.handles["a"].to = Point(100, 130);
    pose.handles["a"].rotate_rad = 0;
    const Image drawn = render(puppet, pose, {}, progress).image;
    ASSERT_EQ(drawn.pixels.type(), CV_8UC3);
    EXPECT_EQ(drawn.pixels.at<cv::Vec3b>(130, 100), cv::Vec3b(255, 0, 0));
    const cv::Rect behind(70, 50, 60, 58);
    EXPECT_LT(cv::norm(drawn.pixels(behind), empty(behind), cv::NORM_L1) / (3.0 * behind.area()), 20);

    puppet.cutout = {};
    try {
        render(puppet, pose, {}, progress);
        FAIL();
    } catch (const InvalidInput& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("whole picture"));
    }
}

// What neither the warp nor the background covers is white in a format without alpha, and only that.
TEST_F(Pipeline, BackgroundsStayInFormatsWithoutAlpha) {
    Image image;
    image.pixels = cv::Mat(100, 100, CV_8UC3, cv::Scalar(40, 90, 60));
    Puppet puppet = puppet_of(image);
    puppet.cutout.from = "polygon";
    puppet.cutout.points = {{30, 30}, {60, 30}, {60, 60}, {30, 60}};
    puppet.rig.handles = {{"a", PointHandle{{45, 45}, {}}}};
    RenderOptions jpeg;
    jpeg.format = "jpeg";
    jpeg.canvas = {CanvasChoice::Kind::given, {-10, 0, 110, 100}};
    for (const char* background : {"keep", "inpaint"}) {
        puppet.background = background;
        const Image drawn = render(puppet, Pose(), jpeg, progress).image;
        EXPECT_EQ(drawn.pixels.at<cv::Vec3b>(50, 5), cv::Vec3b(255, 255, 255)) << background;
        EXPECT_EQ(drawn.pixels.at<cv::Vec3b>(80, 80), cv::Vec3b(40, 90, 60)) << background;
    }
}

TEST_F(Pipeline, BackFacesShowOnDemand) {
    Puppet puppet = puppet_of(square(0));
    puppet.rig.handles = {{"all", RegionHandle{{{0, 0}, {140, 0}, {140, 140}, {0, 140}}, Falloff::none}}};
    puppet.method.method = Method::harmonic;
    Pose pose;
    pose.handles["all"].affine = {-1, 0, 0, 1, 140, 0};
    const Rendered hidden = render(puppet, pose, {}, progress);
    EXPECT_EQ(cv::countNonZero(hidden.image.pixels.reshape(1)), 0);
    EXPECT_EQ(hidden.report.distortion.flipped_triangles, hidden.report.triangles);
    puppet.back_faces = BackFaces::show;
    EXPECT_EQ(render(puppet, pose, {}, progress).image.pixels.at<cv::Vec4b>(50, 70), cv::Vec4b(200, 100, 50, 255));
}

TEST_F(Pipeline, CanvasOverTheLimitIsRefusedBeforeDrawing) {
    const Puppet puppet = puppet_of(square(0));
    RenderOptions options;
    options.canvas = {CanvasChoice::Kind::given, {0, 0, 100'000, 100'000}};
    EXPECT_THROW(render(puppet, default_pose(puppet), options, progress), InvalidInput);
}

TEST_F(Pipeline, NoHandlesAtAllIsAnError) {
    Puppet puppet = puppet_of(square(0));
    puppet.rig.handles.clear();
    EXPECT_THROW(render(puppet, default_pose(puppet), {}, progress), InvalidInput);
}

TEST_F(Pipeline, CancellingLeavesByException) {
    struct Cancelling : Progress {
        bool cancelled() const override { return true; }
    } cancelling;
    const Puppet puppet = puppet_of(square(0));
    EXPECT_THROW(render(puppet, default_pose(puppet), {}, cancelling), Cancelled);
}

TEST_F(Pipeline, StiffnessPicturesAreLumaWithoutAlphaStretchedOverThePicture) {
    Puppet puppet = puppet_of(square(0));
    Image stiff;
    stiff.pixels = cv::Mat(2, 1, CV_16UC4);
    stiff.pixels.at<cv::Vec4w>(0, 0) = {65535, 0, 0, 0};
    stiff.pixels.at<cv::Vec4w>(1, 0) = {0, 0, 65535, 65535};
    write_image(stiff, folder / "stiff.png");
    StiffnessPicture picture;
    picture.path = "stiff.png";
    picture.max = 5;
    puppet.rig.stiffness = {StiffnessRegion{{{0, 0}, {1, 0}, {1, 1}}, 2}, picture};
    const Rig rig = load_rig(puppet, 140, 160);
    const auto& loaded = std::get<StiffnessPicture>(rig.stiffness[1]);
    EXPECT_EQ(loaded.width_px, 140);
    EXPECT_EQ(loaded.height_px, 160);
    ASSERT_EQ(loaded.grey.type(), CV_32FC1);
    EXPECT_NEAR(loaded.grey.at<float>(0, 0), 0.2126, 1e-6);
    EXPECT_NEAR(loaded.grey.at<float>(1, 0), 0.0722, 1e-6);
    EXPECT_EQ(std::get<StiffnessPicture>(load_rig(puppet, 0, 0).stiffness[1]).height_px, 2);
    Image grey;
    grey.pixels = cv::Mat(1, 1, CV_8UC1, cv::Scalar(51));
    write_image(grey, folder / "stiff.png");
    const Rig again = load_rig(puppet, 140, 140);
    EXPECT_NEAR(std::get<StiffnessPicture>(again.stiffness[1]).grey.at<float>(0, 0), 0.2, 1e-6);
    puppet.rig.stiffness = {picture};
    std::get<StiffnessPicture>(puppet.rig.stiffness[0]).path = "gone.png";
    EXPECT_THROW(render(puppet, Pose(), {}, progress), InvalidInput);
}

TEST_F(Pipeline, AWhitePictureIsARegionOfItsMaximum) {
    Puppet puppet = puppet_of(square(0));
    Pose pose;
    pose.handles["b"].to = Point(110, 80);
    Image white;
    white.pixels = cv::Mat(9, 9, CV_8UC3, cv::Scalar::all(255));
    write_image(white, folder / "white.png");
    StiffnessPicture picture;
    picture.path = "white.png";
    picture.max = 7;
    puppet.rig.stiffness = {picture};
    const double by_picture = render(puppet, pose, {}, progress).report.energy;
    puppet.rig.stiffness = {StiffnessRegion{{{-1, -1}, {141, -1}, {141, 141}, {-1, 141}}, 7}};
    EXPECT_EQ(render(puppet, pose, {}, progress).report.energy, by_picture);
}

// Lets the reading of the picture go ahead of its mesh, and counts what else is done.
class WaitingOnce : public Progress {
public:
    int later_steps = 0;

protected:
    void show(std::string_view stage, double /*fraction*/) override {
        if (stage == "read") return;
        if (waited_) ++later_steps;
        if (!waited_) std::this_thread::sleep_for(std::chrono::seconds(1));
        waited_ = true;
    }

private:
    bool waited_ = false;
};

TEST_F(Pipeline, ADamagedPictureEndsTheWorkOnItsMesh) {
    cv::Mat pixels(140, 140, CV_8UC3);
    cv::randu(pixels, 0, 4);
    Puppet puppet = puppet_of({pixels, {}});
    puppet.image = "picture.tif";
    write_image({pixels, {}}, folder / "picture.tif");
    puppet.method.method = Method::lbs;
    // The header is sound, the pixels are not.
    std::fstream file(folder / "picture.tif", std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(static_cast<std::streamoff>(std::filesystem::file_size(folder / "picture.tif") / 2));
    for (int i = 0; i < 2000; ++i) file.put(static_cast<char>(i * i * 37 + i / 7));
    file.close();
    WaitingOnce waiting;
    try {
        render(puppet, {}, {}, waiting);
        FAIL() << "half a picture is drawn";
    } catch (const InvalidInput& error) {
        EXPECT_THAT(error.what(), testing::HasSubstr("damaged"));
    }
    EXPECT_EQ(waiting.later_steps, 0);
}

TEST_F(Pipeline, WarningsReachTheReport) {
    Image two = square(0);
    two.pixels(cv::Rect(0, 60, 140, 20)).setTo(cv::Scalar(0, 0, 0, 0));
    Puppet puppet = puppet_of(two);
    EXPECT_TRUE(render(puppet, Pose(), {}, progress).report.warnings.empty());
    puppet.rig.handles.pop_back();
    const RenderReport report = render(puppet, Pose(), {}, progress).report;
    ASSERT_EQ(report.warnings.size(), 1u);
    EXPECT_THAT(report.warnings[0], testing::HasSubstr("no handle"));
}

}  // namespace
}  // namespace puppetwarp
