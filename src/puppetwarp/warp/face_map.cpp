#include <puppetwarp/warp/face_map.h>

#include <algorithm>
#include <cmath>

namespace puppetwarp::detail {

namespace {

constexpr double longest_step_px = 1 << 29;  // keeps u + count * du inside 64 bits

// Slivers have maps without a single valid digit; what they give must still lie in their triangle. NaN becomes `low`.
double within(double value, double low, double high) {
    return !(value > low) ? low : value < high ? value : high;
}

std::int64_t fixed_point(double value) {
    return static_cast<std::int64_t>(value * fixed_one);
}

}  // namespace

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
    const Eigen::Vector2d a = p1 - p, b = p2 - p, c = q1 - q, d = q2 - q;
    const double area = a.x() * b.y() - a.y() * b.x();
    jacobian_ << c.x() * b.y() - d.x() * a.y(), d.x() * a.x() - c.x() * b.x(),  //
        c.y() * b.y() - d.y() * a.y(), d.y() * a.x() - c.y() * b.x();
    jacobian_ *= area == 0 ? 0 : 1 / area;
    rest_low_ = q.cwiseMin(q1).cwiseMin(q2).array() - 1;
    rest_high_ = q.cwiseMax(q1).cwiseMax(q2).array() + 1;
}

int FaceMap::samples() const {
    const double same = std::hypot(jacobian_(0, 0) + jacobian_(1, 1), jacobian_(1, 0) - jacobian_(0, 1));
    const double opposite = std::hypot(jacobian_(0, 0) - jacobian_(1, 1), jacobian_(1, 0) + jacobian_(0, 1));
    const double largest_stretch = (same + opposite) / 2;
    if (!(largest_stretch > single_sample_limit)) return 1;
    return static_cast<int>(std::ceil(std::min<double>(largest_stretch, most_samples)));
}

Run FaceMap::run(const Eigen::Vector2d& centre, double step, int count) const {
    Eigen::Vector2d first = rest_from_moved(centre);
    Eigen::Vector2d slope = jacobian_.col(0) * step;
    const Eigen::Vector2d last = first + slope * (count - 1);
    const auto inside = [&](const Eigen::Vector2d& p) {
        return (p.array() >= rest_low_).all() && (p.array() <= rest_high_).all();
    };
    if (!inside(first) || !inside(last)) {
        for (int axis = 0; axis < 2; ++axis) {
            first[axis] = within(first[axis], rest_low_[axis], rest_high_[axis]);
            slope[axis] = count == 1 ? 0
                                     : (within(last[axis], rest_low_[axis], rest_high_[axis]) - first[axis]) / (count - 1);
        }
    }
    const auto step_of = [](double s) { return fixed_point(within(s, -longest_step_px, longest_step_px)); };
    return {fixed_point(first.x() - 0.5), fixed_point(first.y() - 0.5), step_of(slope.x()), step_of(slope.y()), count};
}

}  // namespace puppetwarp::detail
