#pragma once

#include <puppetwarp/mesh/triangle_mesh.h>
#include <puppetwarp/warp/sampling.h>

namespace puppetwarp::detail {

//! How far positions may be from a whole-pixel translation of their triangle to count as one. Far above the noise of
//! an iterative solver, far below what shows: at most 3 of 65535 levels between a copy and its neighbour.
inline constexpr double translation_tolerance_px = 5e-5;

//! Where source pixels lie in a view of the picture: (position - corner) / size.
struct ViewFrame {
    std::int64_t x = 0, y = 0;
    std::int64_t size = 1;

    //! Fixed-point positions in the source, from those in the view.
    std::int64_t source_u(std::int64_t u) const { return in_source(u, x); }
    std::int64_t source_v(std::int64_t v) const { return in_source(v, y); }

private:
    std::int64_t in_source(std::int64_t at, std::int64_t corner) const {
        constexpr std::int64_t half = std::int64_t{1} << 31;
        return (at + half) * size - half + (corner << 32);
    }
};

//! The linear part of the map of one triangle, from moved to rest positions: columns are what a step of one pixel to
//! the right, and down, is in the source. 0 for a triangle without area.
Eigen::Matrix2d linear_part(const TriangleMesh& rest, const Eigen::MatrixX2d& moved, int triangle);

//! The affine map of one triangle, from moved to rest positions.
class FaceMap {
public:
    FaceMap(const TriangleMesh& rest, const Eigen::MatrixX2d& moved, int triangle);

    //! True when the triangle moves by whole pixels: source pixel = pixel - shift.
    bool is_copy() const { return is_copy_; }
    Eigen::Vector2i shift() const { return shift_; }

    //! Its linear part.
    const Eigen::Matrix2d& jacobian() const { return jacobian_; }

    //! Positions in the source of pixels side by side.
    //! \param x,y  centre of the first pixel, in image space.
    Run run(double x, double y, int count) const {
        if (ill_conditioned_) return clamped_run(x, y, count, {});
        const double dx = x - anchor_.x(), dy = y - anchor_.y();
        return {fixed_point(rest_anchor_.x() + (jacobian_(0, 0) * dx + jacobian_(0, 1) * dy) - 0.5),
                fixed_point(rest_anchor_.y() + (jacobian_(1, 0) * dx + jacobian_(1, 1) * dy) - 0.5), du_, dv_, count};
    }

    //! What all runs have in common.
    Steps steps() const { return {du_, dv_}; }

    //! Whether the triangle lies inside a rectangle at rest, a pixel away from its border or more.
    bool inside(const Eigen::Array2d& low, const Eigen::Array2d& high) const {
        return !ill_conditioned_ && (rest_low_ >= low).all() && (rest_high_ <= high).all();
    }

    //! The same in a view of the source.
    Run run_in(const ViewFrame& frame, double x, double y, int count) const;

private:
    static std::int64_t fixed_point(double value) { return static_cast<std::int64_t>(value * fixed_one); }
    Run clamped_run(double x, double y, int count, const ViewFrame& frame) const;

    bool is_copy_ = false;
    bool ill_conditioned_ = false;
    Eigen::Vector2i shift_ = Eigen::Vector2i::Zero();
    std::int64_t du_ = 0, dv_ = 0;
    Eigen::Vector2d anchor_, rest_anchor_;  // a corner, moved and at rest: differences to it keep their digits
    Eigen::Matrix2d jacobian_;
    Eigen::Array2d rest_low_, rest_high_;  // bounding box at rest, grown by a pixel
};

}  // namespace puppetwarp::detail
