#include <puppetwarp/deform/skinning.h>

#include <puppetwarp/deform/dual_complex.h>
#include <puppetwarp/deform/similarity_mean.h>

#include <array>
#include <cassert>
#include <cstdio>

namespace puppetwarp {

namespace {

BlendedPositions intrinsic_blend(const WeightRows& W, const Eigen::VectorXcd& z,
                                 const std::vector<SplitMotion>& motions) {
    std::vector<Similarity> similarities;
    similarities.reserve(motions.size());
    for (const SplitMotion& each : motions) similarities.push_back({each.log, each.shift});
    return similarity_mean(W, blend_shears(W, z, motions), similarities);
}

std::string unsteady_warning(const UnsteadyVertices& unsteady, const Eigen::MatrixX2d& V, Method method) {
    std::array<char, 96> text{};
    std::snprintf(text.data(), text.size(), "%d vertices, the worst at (%.5g, %.5g)", unsteady.count,
                  V(unsteady.worst, 0), V(unsteady.worst, 1));
    return "handles that share a part turn about a whole turn against each other: '" + method_name(method) +
           "' has no steady mean of them at " + text.data();
}

}  // namespace

SkinningDeformer::SkinningDeformer(Method method, const TriangleMesh& mesh, const Rig& rig, const Weights& weights)
    : method_(method), V_(mesh.V), rest_(complex_positions(mesh.V)), rig_(rig), weights_(weights, mesh, rig) {}

BlendedPositions SkinningDeformer::blended(const std::vector<ColumnMotion>& motions) const {
    if (method_ == Method::lbs) {
        std::vector<AffineMap> maps;
        maps.reserve(motions.size());
        for (const ColumnMotion& motion : motions) maps.push_back(motion.map);
        return {linear_blend(weights_.rows, rest_, maps), {}};
    }
    const std::vector<SplitMotion> parts = split_motions(motions, rig_, weights_.columns, method_name(method_));
    if (method_ == Method::dual_complex) return dual_complex_blend(weights_.rows, rest_, parts);
    assert(method_ == Method::intrinsic);
    return intrinsic_blend(weights_.rows, rest_, parts);
}

Deformation SkinningDeformer::deform(const Pose& pose, const Eigen::MatrixX2d*, Progress& progress) const {
    progress.step("deform", 0);
    const std::vector<ColumnMotion> motions = column_motions(rig_, pose, weights_.columns, V_);
    BlendedPositions moved = blended(motions);
    weights_.add_imaginary(motions, moved.x);
    Deformation result;
    result.V = point_positions(moved.x);
    result.energy_history = {0};
    result.max_handle_error_px = weights_.largest_error(motions, rest_, moved.x);
    result.warnings = weights_.warnings;
    if (moved.unsteady.count > 0) result.warnings.push_back(unsteady_warning(moved.unsteady, V_, method_));
    return result;
}

}  // namespace puppetwarp
