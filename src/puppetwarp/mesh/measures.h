#pragma once

#include <puppetwarp/mesh/triangle_mesh.h>

namespace puppetwarp {

//! What a mesh is like, in numbers. Lengths are those of its coordinates: pixels, of meshes of pictures.
struct MeshMeasures {
    int components = 0;      //!< parts that no edge connects; a vertex of no triangle is one
    int edges = 0;           //!< each counted once
    int boundary_edges = 0;  //!< of one triangle only
    double area = 0;         //!< of all triangles, never negative
    double longest_edge = 0;
    double smallest_angle_rad = 0;  //!< of any corner of a triangle
    bool clockwise = false;         //!< on screen: y down, as `triangulate` makes them; else counter-clockwise
};

//! \pre `require_sound(mesh)`.
MeshMeasures measure_mesh(const TriangleMesh& mesh);

}  // namespace puppetwarp
