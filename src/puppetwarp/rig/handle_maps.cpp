#include <puppetwarp/rig/handle_maps.h>

#include <puppetwarp/rig/bones.h>
#include <puppetwarp/rig/region.h>

namespace puppetwarp {

namespace {

using Complex = std::complex<double>;

Complex complex_of(const Point& p) {
    return {p.x(), p.y()};
}

// Of the handles that are no bones.
struct MapOf {
    const HandlePose& pose;
    const Eigen::MatrixX2d& V;

    AffineMap about(const Complex& centre) const {
        if (pose.affine) return affine_map(*pose.affine);
        const Complex turn = std::polar(pose.scale.value_or(1), pose.rotate_rad.value_or(0));
        return similarity_about(centre, turn, pose.to ? complex_of(*pose.to) : centre);
    }
    AffineMap operator()(const PointHandle& point) const { return about(complex_of(point.at)); }
    AffineMap operator()(const RegionHandle& region) const { return about(complex_of(region_centroid(region.points))); }
    AffineMap operator()(const VertexHandle& vertex) const {
        return vertex.index < V.rows() ? about(complex_of(V.row(vertex.index).transpose())) : AffineMap();
    }
    AffineMap operator()(const BoneHandle&) const { return {}; }
    AffineMap operator()(const CageHandle&) const { return {}; }
};

}  // namespace

std::vector<AffineMap> handle_maps(const Rig& rig, const Pose& pose, const Eigen::MatrixX2d& V) {
    std::vector<AffineMap> maps = bone_maps(rig, pose);
    for (std::size_t h = 0; h < maps.size(); ++h) {
        const Handle& handle = rig.handles[h];
        const auto found = pose.handles.find(handle.id);
        if (found == pose.handles.end() || std::holds_alternative<BoneHandle>(handle.shape)) continue;
        maps[h] = std::visit(MapOf{found->second, V}, handle.shape);
    }
    return maps;
}

}  // namespace puppetwarp
