#include <puppetwarp/mesh/distortion.h>

#include <Eigen/LU>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace puppetwarp {

namespace {

// Columns are two edge vectors of triangle t.
Eigen::Matrix2d edges_of(const Eigen::MatrixX2d& V, const Eigen::MatrixX3i& F, Eigen::Index t) {
    Eigen::Matrix2d edges;
    edges.col(0) = (V.row(F(t, 1)) - V.row(F(t, 0))).transpose();
    edges.col(1) = (V.row(F(t, 2)) - V.row(F(t, 0))).transpose();
    return edges;
}

// Of a 2 x 2 matrix, without cancellation: the lengths of its conformal and its anticonformal part add up.
double largest_singular_value(const Eigen::Matrix2d& J) {
    return (std::hypot(J(0, 0) + J(1, 1), J(1, 0) - J(0, 1)) + std::hypot(J(0, 0) - J(1, 1), J(1, 0) + J(0, 1))) / 2;
}

// How triangle t of the rest mesh is mapped.
Eigen::Matrix2d map_of(const TriangleMesh& rest, const Eigen::MatrixX2d& moved, Eigen::Index t) {
    return edges_of(moved, rest.F, t) * edges_of(rest.V, rest.F, t).inverse();
}

}  // namespace

Distortion measure_distortion(const TriangleMesh& rest, const Eigen::MatrixX2d& moved) {
    assert(moved.rows() == rest.V.rows());
    Distortion distortion;
    double stretch = 0;
    for (Eigen::Index t = 0; t < rest.F.rows(); ++t) {
        const Eigen::Matrix2d J = map_of(rest, moved, t);
        const double area_ratio = J.determinant();
        if (!(area_ratio > 0)) ++distortion.flipped_triangles;
        stretch = std::max(stretch, largest_singular_value(J));
        const double size = std::abs(area_ratio);
        const double ratio = size > 0 ? std::max(size, 1 / size) : std::numeric_limits<double>::infinity();
        distortion.max_area_ratio = std::max(distortion.max_area_ratio, ratio);
    }
    if (rest.F.rows() > 0) distortion.max_stretch = stretch;
    return distortion;
}

double largest_magnification(const TriangleMesh& rest, const Eigen::MatrixX2d& moved) {
    assert(moved.rows() == rest.V.rows());
    double largest = 0;
    for (Eigen::Index t = 0; t < rest.F.rows(); ++t) {
        const Eigen::Matrix2d J = map_of(rest, moved, t);
        if (J.determinant() > 0) largest = std::max(largest, largest_singular_value(J));
    }
    return largest;
}

Eigen::MatrixX2d principal_stretches(const TriangleMesh& rest, const Eigen::MatrixX2d& moved) {
    assert(moved.rows() == rest.V.rows());
    Eigen::MatrixX2d stretches(rest.F.rows(), 2);
    for (Eigen::Index t = 0; t < rest.F.rows(); ++t) {
        const Eigen::Matrix2d J = map_of(rest, moved, t);
        const double larger = largest_singular_value(J);
        stretches.row(t) << larger, larger > 0 ? J.determinant() / larger : 0;
    }
    return stretches;
}

}  // namespace puppetwarp
