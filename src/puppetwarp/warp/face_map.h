#pragma once

#include <puppetwarp/mesh/triangle_mesh.h>
#include <puppetwarp/warp/sampling.h>

namespace puppetwarp::detail {

//! How far positions may be from a whole-pixel translation of their triangle to count as one. Far above the noise of
//! an iterative solver, far below what shows: at most 3 of 65535 levels between a copy and its neighbour.
inline constexpr double translation_tolerance_px = 5e-5;

//! Up to this shrinking factor one sample a pixel does; above, as many along each axis as the factor, rounded up.
inline constexpr double single_sample_limit = 1.5;
inline constexpr int most_samples = 4;

//! The affine map of one triangle, from moved to rest positions.
class FaceMap {
public:
    FaceMap(const TriangleMesh& rest, const Eigen::MatrixX2d& moved, int triangle);

    //! True when the triangle moves by whole pixels: source pixel = pixel - shift.
    bool is_copy() const { return is_copy_; }
    Eigen::Vector2i shift() const { return shift_; }

    //! Samples along each axis that a pixel needs so that shrinking does not alias, 1 to 4.
    int samples() const;

    //! \param x,y    centre of the first pixel, in image space.
    //! \param step   from one pixel to the next.
    Run run(double x, double y, double step, int count) const {
        if (ill_conditioned_) return clamped_run(x, y, step, count);
        const double dx = x - anchor_.x(), dy = y - anchor_.y();
        return {fixed_point(rest_anchor_.x() + (jacobian_(0, 0) * dx + jacobian_(0, 1) * dy) - 0.5),
                fixed_point(rest_anchor_.y() + (jacobian_(1, 0) * dx + jacobian_(1, 1) * dy) - 0.5),
                fixed_point(jacobian_(0, 0) * step), fixed_point(jacobian_(1, 0) * step), count};
    }

private:
    static std::int64_t fixed_point(double value) { return static_cast<std::int64_t>(value * fixed_one); }
    Run clamped_run(double x, double y, double step, int count) const;

    bool is_copy_ = false;
    bool ill_conditioned_ = false;
    Eigen::Vector2i shift_ = Eigen::Vector2i::Zero();
    Eigen::Vector2d anchor_, rest_anchor_;  // a corner, moved and at rest: differences to it keep their digits
    Eigen::Matrix2d jacobian_;
    Eigen::Array2d rest_low_, rest_high_;  // bounding box at rest
};

}  // namespace puppetwarp::detail
