#include <puppetwarp/deform/skinning_motions.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/rig/bones.h>
#include <puppetwarp/rig/handle_maps.h>
#include <puppetwarp/rig/region.h>

#include <cmath>
#include <numbers>

namespace puppetwarp {

namespace {

using Complex = std::complex<double>;

// A map whose shear comes nearer to its turn than this share flattens what it moves to a line.
constexpr double flat = 1e-9;

Complex complex_of(const Point& p) {
    return {p.x(), p.y()};
}

const HandlePose* pose_of(const Pose& pose, const std::string& id) {
    const auto found = pose.handles.find(id);
    return found == pose.handles.end() ? nullptr : &found->second;
}

// The angle of a turn that is nearest to another.
double angle_near(const Complex& turn, double other_rad) {
    return other_rad + std::remainder(std::arg(turn) - other_rad, 2 * std::numbers::pi);
}

class Motions {
public:
    Motions(const Rig& rig, const Pose& pose, const Eigen::MatrixX2d& V)
        : rig_(rig),
          pose_(pose),
          V_(V),
          size_(bounding_diagonal(V)),
          maps_(handle_maps(rig, pose, V)),
          bones_(bone_motions(rig, pose)) {}

    ColumnMotion of(const WeightColumn& column) const {
        const Handle& handle = rig_.handles[static_cast<std::size_t>(column.handle)];
        ColumnMotion motion;
        if (const auto* cage = std::get_if<CageHandle>(&handle.shape)) {
            const auto corner = static_cast<std::size_t>(column.corner);
            const HandlePose* target = pose_of(pose_, handle.id);
            motion.centre = complex_of(cage->points[corner]);
            if (target != nullptr && target->points) {
                motion.map.shift = complex_of((*target->points)[corner]) - motion.centre;
            }
        } else {
            motion.map = maps_[static_cast<std::size_t>(column.handle)];
            motion.centre = centre(handle);
            motion.angle_rad = turn_rad(column.handle);
        }
        if (!(std::abs(motion.map(motion.centre) - motion.centre) <= farthest_move * size_)) {
            throw InvalidInput("handle '" + handle.id + "'", "its target is too far away",
                               "stay within a million times the subject's size");
        }
        return motion;
    }

private:
    Complex centre(const Handle& handle) const {
        if (const auto* point = std::get_if<PointHandle>(&handle.shape)) return complex_of(point->at);
        if (const auto* bone = std::get_if<BoneHandle>(&handle.shape)) return complex_of(bone->from);
        if (const auto* region = std::get_if<RegionHandle>(&handle.shape)) {
            return complex_of(region_centroid(region->points));
        }
        return complex_of(V_.row(std::get<VertexHandle>(handle.shape).index).transpose());
    }

    // How far a handle turns: a bone along its chain, the others as the pose says.
    double turn_rad(int index) const {
        const Handle& handle = rig_.handles[static_cast<std::size_t>(index)];
        if (std::holds_alternative<BoneHandle>(handle.shape)) return bones_[static_cast<std::size_t>(index)].angle_rad;
        const HandlePose* target = pose_of(pose_, handle.id);
        const double said = target == nullptr ? 0 : target->rotate_rad.value_or(0);
        return angle_near(maps_[static_cast<std::size_t>(index)].alpha, said);
    }

    const Rig& rig_;
    const Pose& pose_;
    const Eigen::MatrixX2d& V_;
    double size_;
    std::vector<AffineMap> maps_;
    std::vector<BoneMotion> bones_;
};

}  // namespace

std::vector<ColumnMotion> column_motions(const Rig& rig, const Pose& pose, const std::vector<WeightColumn>& columns,
                                         const Eigen::MatrixX2d& V) {
    require_sound(pose, rig);
    const Motions all(rig, pose, V);
    std::vector<ColumnMotion> motions;
    motions.reserve(columns.size());
    for (const WeightColumn& column : columns) motions.push_back(all.of(column));
    return motions;
}

std::vector<SplitMotion> split_motions(const std::vector<ColumnMotion>& motions, const Rig& rig,
                                       const std::vector<WeightColumn>& columns, std::string_view method) {
    std::vector<SplitMotion> parts;
    parts.reserve(motions.size());
    for (std::size_t j = 0; j < motions.size(); ++j) {
        const auto& [map, angle_rad, centre] = motions[j];
        if (!(std::abs(map.beta) < (1 - flat) * std::abs(map.alpha))) {
            throw InvalidInput("handle '" + column_name(rig, columns[j]) + "'",
                               "'" + std::string(method) + "' cannot blend a map that mirrors or flattens",
                               "use the method lbs");
        }
        parts.push_back({map.beta / map.alpha, Complex(std::log(std::abs(map.alpha)), angle_rad),
                         map(centre) - map.alpha * centre, centre});
    }
    return parts;
}

}  // namespace puppetwarp
