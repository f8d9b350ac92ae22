// Triangulates a square, pulls one corner, checks that the pin was met: through installed headers only.
#include <puppetwarp/deform/deformer.h>
#include <puppetwarp/mesh/triangulate.h>
#include <puppetwarp/project/puppet.h>
#include <puppetwarp/warp/warp.h>

int main() {
    using namespace puppetwarp;
    const TriangleMesh mesh = triangulate(rectangle_outline(100, 80), {}, {.max_edge_px = 8});
    Rig rig;
    rig.handles = {{"left", PointHandle{{20, 40}, {}}}, {"right", PointHandle{{80, 40}, {}}}};
    Pose pose;
    pose.handles["right"].to = Point(85, 30);
    Progress progress;
    const Deformation deformation = make_deformer({}, mesh, rig)->deform(pose, nullptr, progress);
    Image image;
    image.pixels = cv::Mat(80, 100, CV_8UC3, cv::Scalar(10, 20, 30));
    const Image warped = warp(image, mesh, deformation.V);
    const bool good =
        deformation.max_handle_error_px < 0.01 && warped.width() == 100 && find_pose(Puppet(), "rest").name == "rest";
    return good ? 0 : 1;
}
