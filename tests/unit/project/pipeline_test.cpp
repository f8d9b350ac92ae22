#include "support/run_command.h"

#include <puppetwarp/base/errors.h>
#include <puppetwarp/image/write.h>
#include <puppetwarp/project/pipeline.h>

#include <opencv2/core.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

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

}  // namespace
}  // namespace puppetwarp
