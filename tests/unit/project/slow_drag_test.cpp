// A limb drawn slowly over the body, through the whole pipeline but for files.

#include <puppetwarp/project/pipeline.h>
#include <puppetwarp/rig/depth.h>
#include <puppetwarp/warp/painters_order.h>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <cmath>

namespace puppetwarp {
namespace {

constexpr int frames = 300;
constexpr double step_px = 0.1;

// A body and, left of it, an arm that is joined to it at the shoulder; soft shading, soft edges.
class SlowDrag : public testing::Test {
protected:
    SlowDrag() {
        cv::Mat alpha(110, 130, CV_8U, cv::Scalar(0));
        cv::rectangle(alpha, {60, 12, 46, 88}, 255, cv::FILLED);
        cv::rectangle(alpha, {36, 16, 26, 14}, 255, cv::FILLED);
        cv::rectangle(alpha, {36, 16, 14, 60}, 255, cv::FILLED);
        cv::GaussianBlur(alpha, alpha, {}, 1.0);
        image.pixels.create(alpha.size(), CV_8UC4);
        for (int y = 0; y < alpha.rows; ++y) {
            for (int x = 0; x < alpha.cols; ++x) {
                const bool arm = x < 59;
                image.pixels.at<cv::Vec4b>(y, x) = {
                    static_cast<std::uint8_t>(arm ? 220 : 60 + x / 4), static_cast<std::uint8_t>(90 + y / 2),
                    static_cast<std::uint8_t>(arm ? 40 : 190 - y / 4), alpha.at<std::uint8_t>(y, x)};
            }
        }
        puppet.mesh.max_edge_px = 7;
        puppet.rig.handles = {{"hand", PointHandle{{43, 68}, 4.0}},
                              {"elbow", PointHandle{{43, 24}, 4.0}},
                              {"chest", PointHandle{{84, 30}, 4.0}},
                              {"hip", PointHandle{{84, 88}, 4.0}}};
        cutout = cut_out(image);
        mesh = mesh_subject(puppet, outline_subject(puppet, image.width(), image.height(), cutout));
        deformer = make_deformer(puppet.method, mesh, puppet.rig);
    }

    Pose pose(int frame, double depth) const {
        Pose pose;
        // Round the elbow, so that nothing is squeezed until it buckles.
        const double angle = step_px * frame / 44;
        pose.handles["hand"].to = Point(43 + 44 * std::sin(angle), 24 + 44 * std::cos(angle));
        pose.handles["hand"].depth = pose.handles["elbow"].depth = depth;
        return pose;
    }

    Image drawn(const Pose& pose, Eigen::VectorXi& order) {
        RenderReport report;
        const Eigen::VectorXd depth = vertex_depths(mesh, puppet.rig, pose);
        order = painters_order(mesh, depth);
        const Deformation deformation = deformer->deform(pose, nullptr, progress);
        EXPECT_TRUE(deformation.converged);
        return draw_subject(puppet, image, cutout, mesh, deformation.V, depth, {}, report, progress);
    }

    Image image;
    Puppet puppet;
    Cutout cutout;
    TriangleMesh mesh;
    std::unique_ptr<Deformer> deformer;
    Progress progress;
};

// Premultiplied: what is nearly transparent has nearly no colour to change.
cv::Mat premultiplied(const Image& image) {
    cv::Mat values, alpha;
    image.pixels.convertTo(values, CV_32F);
    cv::extractChannel(values, alpha, 3);
    cv::merge(std::vector<cv::Mat>(4, alpha / 255), alpha);
    cv::Mat result = values.mul(alpha);
    return result;
}

TEST_F(SlowDrag, ChangesNoOrderAndNothingPops) {
    for (const double depth : {1.0, -1.0}) {
        Eigen::VectorXi first, order;
        cv::Mat before = premultiplied(drawn(pose(0, depth), first));
        double most = 0, most_sum = 0;
        for (int frame = 1; frame <= frames; ++frame) {
            const Image picture = drawn(pose(frame, depth), order);
            ASSERT_EQ(order, first) << "frame " << frame;
            const cv::Mat now = premultiplied(picture);
            const cv::Mat difference = cv::abs(now - before);
            double largest = 0;
            cv::minMaxLoc(difference.reshape(1), nullptr, &largest);
            most = std::max(most, largest);
            const cv::Scalar sums = cv::sum(difference);
            most_sum = std::max(most_sum, sums[0] + sums[1] + sums[2] + sums[3]);
            before = now;
        }
        // The edge of the limb is some two pixels wide and passes over 220 levels: it changes a pixel by 0.1 px of
        // that. What comes up from below in one frame would change it by a hundred or more.
        EXPECT_LT(most, 30) << "depth " << depth;
        // A hundred and fifty pixels of edge, four channels, half of them at a time.
        EXPECT_LT(most_sum, 24000) << "depth " << depth;
        // At the end the hand is on the body.
        const Image last = drawn(pose(frames, depth), order);
        const auto shown = last.pixels.at<cv::Vec4b>(58, 69);
        EXPECT_EQ(shown[3], 255);
        if (depth > 0) {
            EXPECT_GT(shown[0], 200);
        } else {
            EXPECT_LT(shown[0], 100);
        }
    }
}

// The same positions, other depths: only those of depths that pass each other change places.
TEST_F(SlowDrag, OrderFollowsDepthsAlone) {
    Eigen::VectorXi last;
    int changes = 0;
    for (int i = 0; i <= 20; ++i) {
        const double depth = 0.1 * i - 1;
        const Eigen::VectorXd depths = vertex_depths(mesh, puppet.rig, pose(0, depth));
        const Eigen::VectorXi order = painters_order(mesh, depths);
        // Harmonic depths between two values scale with their difference: the order turns round once, where they pass.
        if (i > 0 && order != last) ++changes;
        last = order;
    }
    EXPECT_LE(changes, 2);
    EXPECT_GE(changes, 1);
}

}  // namespace
}  // namespace puppetwarp
