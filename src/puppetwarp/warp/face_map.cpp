#include <puppetwarp/warp/face_map.h>

#include <algorithm>
#include <cmath>

namespace puppetwarp::detail {

namespace {

// Up to this slope (2^14 source pixels a pixel) rounding moves a sample by less than a pixel.
constexpr double steepest_sound_slope = 1 << 14;

// Slivers have maps without a single valid digit; what they give must still lie in their triangle. NaN becomes `low`.
double within(double value, double low, double high) {
    return !(value > low) ? low : value < high ? value : high;
}

}  // namespace

Eigen::Matrix2d linear_part(const TriangleMesh& rest, const Eigen::MatrixX2d& moved, int triangle) {
    const Eigen::Vector3i face = rest.F.row(triangle);
    const Eigen::RowVector2d a = moved.row(face[1]) - moved.row(face[0]), b = moved.row(face[2]) - moved.row(face[0]);
    const Eigen::RowVector2d c = rest.V.row(face[1]) - rest.V.row(face[0]);
    const Eigen::RowVector2d d = rest.V.row(face[2]) - rest.V.row(face[0]);
    const double area = a.x() * b.y() - a.y() * b.x();
    Eigen::Matrix2d jacobian;
    jacobian << c.x() * b.y() - d.x() * a.y(), d.x() * a.x() - c.x() * b.x(),  //
        c.y() * b.y() - d.y() * a.y(), d.y() * a.x() - c.y() * b.x();
    return jacobian * (area == 0 ? 0 : 1 / area);
}

FaceMap::FaceMap(const TriangleMesh& rest, const Eigen::MatrixX2d& moved, int triangle) {
    const Eigen::Vector3i face = rest.F.row(triangle);
    const Eigen::Vector2d p = moved.row(face[0]), q = rest.V.row(face[0]);
    const Eigen::Vector2d p1 = moved.row(face[1]), q1 = rest.V.row(face[1]);
    const Eigen::Vector2d p2 = moved.row(face[2]), q2 = rest.V.row(face[2]);
    const Eigen::Vector2d offset = (p - q).array().round();
    const auto off = [&](const Eigen::Vector2d& to, const Eigen::Vector2d& from) {
        return (to - from - offset).lpNorm<Eigen::Infinity>();
    };
    is_copy_ = std::max({off(p, q), off(p1, q1), off(p2, q2)}) <= translation_tolerance_px;
    shift_ = offset.cast<int>();
    anchor_ = p;
    rest_anchor_ = q;
    jacobian_ = linear_part(rest, moved, triangle);
    ill_conditioned_ = !(jacobian_.lpNorm<Eigen::Infinity>() <= steepest_sound_slope);
    if (!ill_conditioned_) {
        du_ = fixed_point(jacobian_(0, 0));
        dv_ = fixed_point(jacobian_(1, 0));
    }
    rest_low_ = q.cwiseMin(q1).cwiseMin(q2).array() - 1;
    rest_high_ = q.cwiseMax(q1).cwiseMax(q2).array() + 1;
}

Run FaceMap::run_in(const ViewFrame& frame, double x, double y, int count) const {
    if (ill_conditioned_) return clamped_run(x, y, count, frame);
    const double dx = x - anchor_.x(), dy = y - anchor_.y();
    const auto size = static_cast<double>(frame.size);
    const auto at = [&](int axis, std::int64_t corner) {
        const double position = rest_anchor_[axis] + (jacobian_(axis, 0) * dx + jacobian_(axis, 1) * dy);
        return fixed_point((position - static_cast<double>(corner)) / size - 0.5);
    };
    return {at(0, frame.x), at(1, frame.y), fixed_point(jacobian_(0, 0) / size), fixed_point(jacobian_(1, 0) / size),
            count};
}

Run FaceMap::clamped_run(double x, double y, int count, const ViewFrame& frame) const {
    std::int64_t start[2], slope[2];
    const double corner[2] = {static_cast<double>(frame.x), static_cast<double>(frame.y)};
    const auto size = static_cast<double>(frame.size);
    for (int axis = 0; axis < 2; ++axis) {
        const auto at = [&](double px) {
            const double moved = jacobian_(axis, 0) * (px - anchor_.x()) + jacobian_(axis, 1) * (y - anchor_.y());
            const double position = within(rest_anchor_[axis] + moved, rest_low_[axis], rest_high_[axis]);
            return (position - corner[axis]) / size;
        };
        const double first = at(x), last = at(x + (count - 1));
        start[axis] = fixed_point(first - 0.5);
        slope[axis] = count == 1 ? 0 : fixed_point((last - first) / (count - 1));
    }
    return {start[0], start[1], slope[0], slope[1], count};
}

}  // namespace puppetwarp::detail
