#pragma once

#include <puppetwarp/mesh/outline.h>
#include <puppetwarp/mesh/triangle_mesh.h>

namespace puppetwarp {

struct TriangulationOptions {
    double max_edge_px = 0;       //!< longest edge; 0: a share of the outline's size (`default_max_edge_px`)
    double min_angle_deg = 25;    //!< smallest angle away from sharp corners of the input, 0 to 30
    int max_vertices = 500'000;   //!< more is refused rather than tried
    int optimize_iterations = 0;  //!< rounds of smoothing after refinement: vertices to their patches' centroids
};

//! The edge length that `max_edge_px = 0` means: a fixed share of the outline's size.
double default_max_edge_px(const Outline& outline);

//! Triangles that cover `outline`, none with an edge longer than `options.max_edge_px`.
//! \param constraints  open polylines that become edges of the mesh: bones, cage edges inside the outline. Parts
//!        outside the outline or nearer to its boundary than a tenth of the longest edge are left out, because they
//!        would force tiny triangles. A polyline of one point becomes a vertex, by the same rule; nearer than a
//!        hundredth of the longest edge to another constraint, the vertex lies on that.
//! \throw InvalidInput  the outline is empty, crosses or touches itself (says where), a coordinate is not finite,
//!        `min_angle_deg` outside 0-30, `max_edge_px` negative or not finite, more than `max_vertices` would be needed,
//!        parts so narrow for their length that round-off makes triangles flat.
//! Shewchuk 2002, Delaunay refinement; CGAL 2D Mesh Generation. The same input gives the same mesh.
TriangleMesh triangulate(const Outline& outline, const std::vector<Polyline>& constraints = {},
                         const TriangulationOptions& options = {});

}  // namespace puppetwarp
