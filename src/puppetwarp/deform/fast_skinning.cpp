#include <puppetwarp/deform/fast_skinning.h>

#include <puppetwarp/base/errors.h>

#include <cmath>

namespace puppetwarp {

namespace {

using Complex = std::complex<double>;

// What of a column's motion the energy decides.
enum class Freedom { none, direction, map };

// \param target  what the pose says of the handle, or null.
Freedom freedom_of(const Handle& handle, const HandlePose* target) {
    const bool point =
        std::holds_alternative<PointHandle>(handle.shape) || std::holds_alternative<VertexHandle>(handle.shape);
    if (!point) return Freedom::none;
    if (target == nullptr) return Freedom::map;
    if (target->rotate_rad || target->affine) return Freedom::none;
    return target->scale ? Freedom::direction : Freedom::map;
}

const HandlePose* pose_of(const Pose& pose, const Handle& handle) {
    const auto found = pose.handles.find(handle.id);
    return found == pose.handles.end() ? nullptr : &found->second;
}

Eigen::VectorXcd centres_of(const TriangleMesh& mesh, const Rig& rig, const std::vector<WeightColumn>& columns) {
    const std::vector<ColumnMotion> motions = column_motions(rig, Pose(), columns, mesh.V);
    Eigen::VectorXcd centres(static_cast<Eigen::Index>(motions.size()));
    for (Eigen::Index j = 0; j < centres.size(); ++j) centres(j) = motions[static_cast<std::size_t>(j)].centre;
    return centres;
}

}  // namespace

// A pose as seen after the rigid motion z -> turn z + shift, which the energy does not feel: there, what moves rigidly
// as a whole rests, and small energies are no differences of large numbers.
struct FastSkinningDeformer::Frame {
    Complex turn = 1;
    Complex shift;
    Eigen::VectorXcd d;  // of SubspaceArap: as posed, free maps as at rest or turned as far as the pose says
};

FastSkinningDeformer::FastSkinningDeformer(const MethodOptions& options, const TriangleMesh& mesh, const Rig& rig,
                                           const Weights& weights)
    : options_(options),
      V_(mesh.V),
      rest_(complex_positions(mesh.V)),
      rig_(rig),
      weights_(weights, mesh, rig),
      centres_(centres_of(mesh, rig, weights.columns)),
      arap_(mesh, triangle_stiffness(mesh, rig.stiffness), weights_.rows, centres_) {
    if (weights_.imaginary.size() > 0) {
        throw InvalidInput("weights", "'fast' cannot use the complex weights of a cage", "use the method lbs");
    }
}

std::vector<SubspaceUnknown> FastSkinningDeformer::unknowns(const Pose& pose) const {
    std::vector<SubspaceUnknown> found;
    for (std::size_t j = 0; j < weights_.columns.size(); ++j) {
        const Handle& handle = rig_.handles[static_cast<std::size_t>(weights_.columns[j].handle)];
        const Freedom freedom = freedom_of(handle, pose_of(pose, handle));
        const auto turn = static_cast<Eigen::Index>(3 * j + 1);
        if (freedom == Freedom::direction) found.push_back({turn, {}});
        if (freedom != Freedom::map) continue;
        for (const Eigen::Index entry : {turn, turn + 1}) {
            found.push_back({entry, Complex(1, 0)});
            found.push_back({entry, Complex(0, 1)});
        }
    }
    return found;
}

FastSkinningDeformer::Frame FastSkinningDeformer::frame_of(const std::vector<ColumnMotion>& motions,
                                                           const Pose& pose) const {
    const auto columns = static_cast<Eigen::Index>(motions.size());
    Eigen::VectorXcd places(columns);
    for (Eigen::Index j = 0; j < columns; ++j) places(j) = motions[static_cast<std::size_t>(j)].map(centres_(j));
    const Complex from = centres_.mean(), to = places.mean();
    const double radius = default_disc_share * bounding_diagonal(V_);
    Complex turn = 0;
    for (Eigen::Index j = 0; j < columns; ++j) {
        turn += std::conj(centres_(j) - from) * (places(j) - to);
        const WeightColumn& column = weights_.columns[static_cast<std::size_t>(j)];
        const Handle& handle = rig_.handles[static_cast<std::size_t>(column.handle)];
        if (column.corner >= 0 || freedom_of(handle, pose_of(pose, handle)) != Freedom::none) continue;
        turn += radius * radius * motions[static_cast<std::size_t>(j)].map.alpha;
    }
    Frame frame;
    if (std::abs(turn) > 0) frame.turn = turn / std::abs(turn);
    frame.shift = to - frame.turn * from;
    frame.d.resize(3 * columns);
    for (Eigen::Index j = 0; j < columns; ++j) {
        const AffineMap& map = motions[static_cast<std::size_t>(j)].map;
        const Handle& handle =
            rig_.handles[static_cast<std::size_t>(weights_.columns[static_cast<std::size_t>(j)].handle)];
        const HandlePose* target = pose_of(pose, handle);
        Complex alpha = map.alpha;
        if (freedom_of(handle, target) != Freedom::none) {
            const bool known = target != nullptr && target->turn_rad;
            alpha = std::abs(alpha) * (known ? std::polar(1.0, *target->turn_rad) : frame.turn);
        }
        frame.d(3 * j) = std::conj(frame.turn) * (places(j) - to) - (centres_(j) - from);
        frame.d(3 * j + 1) = std::conj(frame.turn) * alpha - 1.0;
        frame.d(3 * j + 2) = std::conj(frame.turn) * map.beta;
    }
    return frame;
}

Deformation FastSkinningDeformer::deform(const Pose& pose, const Eigen::MatrixX2d* start, Progress& progress) const {
    progress.step("deform", 0);
    std::vector<ColumnMotion> motions = column_motions(rig_, pose, weights_.columns, V_);
    const Frame frame = frame_of(motions, pose);
    Eigen::VectorXcd rotations;
    if (start != nullptr) rotations = std::conj(frame.turn) * (arap_.sums * complex_positions(*start));
    const SubspaceMinimum minimum =
        minimise(arap_, unknowns(pose), frame.d, rotations, options_.tolerance, options_.max_iterations);

    std::vector<AffineMap> maps;
    maps.reserve(motions.size());
    for (Eigen::Index j = 0; j < centres_.size(); ++j) {
        ColumnMotion& motion = motions[static_cast<std::size_t>(j)];
        const Complex place = motion.map(centres_(j));
        motion.map.alpha = frame.turn * (1.0 + minimum.d(3 * j + 1));
        motion.map.beta = frame.turn * minimum.d(3 * j + 2);
        motion.map.shift = place - motion.map.alpha * centres_(j) - motion.map.beta * std::conj(centres_(j));
        maps.push_back(motion.map);
    }
    const Eigen::VectorXcd x = linear_blend(weights_.rows, rest_, maps);
    Deformation result;
    result.V = point_positions(x);
    result.iterations = minimum.iterations;
    result.converged = minimum.converged;
    result.energy_history = minimum.energies;
    result.energy = minimum.energies.back();
    result.max_handle_error_px = weights_.largest_error(motions, rest_, x);
    result.warnings = weights_.warnings;
    return result;
}

}  // namespace puppetwarp
