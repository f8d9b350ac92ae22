#pragma once

#include <puppetwarp/mesh/triangle_mesh.h>

namespace puppetwarp {

//! How far a deformation is from keeping every triangle's shape.
struct Distortion {
    int flipped_triangles = 0;  //!< triangles whose orientation changed, or of no area
    double max_stretch = 1;     //!< largest singular value of any triangle's map
    double max_area_ratio = 1;  //!< largest of moved / rest area and its inverse; infinite for a collapsed triangle
};

//! \param moved  #V x 2 deformed positions.
Distortion measure_distortion(const TriangleMesh& rest, const Eigen::MatrixX2d& moved);

//! Singular values of each triangle's map.
//! \param moved  #V x 2 deformed positions.
//! \return #F x 2: the larger, at least 0, and the smaller, below 0 where the triangle is folded over. Their product is
//!         moved / rest area.
Eigen::MatrixX2d principal_stretches(const TriangleMesh& rest, const Eigen::MatrixX2d& moved);

//! The most pixels that a pixel becomes along any direction: the largest singular value of any triangle's map, of those
//! that keep their orientation. 0 when there are none.
//! \param moved  #V x 2 positions in the result.
double largest_magnification(const TriangleMesh& rest, const Eigen::MatrixX2d& moved);

}  // namespace puppetwarp
