#include <puppetwarp/rig/snap.h>

#include <puppetwarp/mesh/locate.h>
#include <puppetwarp/rig/binding.h>

namespace puppetwarp {

namespace {

// How far a snapped point goes from the border towards the middle of the triangle there: enough for round-off not to
// put it outside again, too little to see.
constexpr double inward_share = 1e-3;

Point place_of(const TriangleMesh& mesh, int triangle, Eigen::Vector3d barycentric) {
    barycentric += inward_share * (Eigen::Vector3d::Constant(1.0 / 3) - barycentric);
    Point place = Point::Zero();
    for (int k = 0; k < 3; ++k) place += barycentric(k) * mesh.V.row(mesh.F(triangle, k)).transpose();
    return place;
}

}  // namespace

Rig snapped(const Rig& rig, const TriangleMesh& mesh, double max_px) {
    const MeshLocator locator(mesh);
    const double size = bounding_diagonal(mesh.V);
    const auto snap = [&](const std::string& id, Point& at) {
        const MeshLocation location = locator.locate(at);
        if (location.distance_px <= on_border * size) return;
        if (location.distance_px > max_px) throw_outside(id, location.distance_px);
        at = place_of(mesh, location.triangle, location.barycentric);
    };
    Rig result = rig;
    for (Handle& handle : result.handles) {
        if (auto* point = std::get_if<PointHandle>(&handle.shape)) {
            snap(handle.id, point->at);
        } else if (auto* bone = std::get_if<BoneHandle>(&handle.shape)) {
            // Bones that share a joint go on sharing it: what is moved is the same for both.
            snap(handle.id, bone->from);
            snap(handle.id, bone->to);
        }
    }
    return result;
}

}  // namespace puppetwarp
