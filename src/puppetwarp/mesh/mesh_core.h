#pragma once
// Private header.

#include <puppetwarp/mesh/triangle_mesh.h>

#include <utility>
#include <vector>

namespace puppetwarp {

//! The triangles of a mesh that stay as they are while others around them are made anew.
class MeshCore {
public:
    //! All triangles, of positive area and with Delaunay edges.
    //! \pre `require_sound(mesh, ...)`.
    explicit MeshCore(const TriangleMesh& mesh);

    //! #F x 3, of the mesh's vertices: its triangles, of the core or not.
    const Eigen::MatrixX3i& triangles() const { return F_; }
    bool holds(Eigen::Index triangle) const { return core_[static_cast<std::size_t>(triangle)]; }
    //! Edges of one triangle of the mesh alone, as it runs.
    std::vector<std::pair<int, int>> boundary() const;
    //! Edges between a triangle of the core and one that is not, or none, as the core's runs.
    std::vector<std::pair<int, int>> border() const;
    //! Of each vertex: whether it has triangles, and all are of the core.
    std::vector<bool> inner_vertices() const;

    //! Takes every triangle at one of these vertices out, and `layers` more around them.
    void loosen(std::vector<bool> vertices, int layers);

private:
    Eigen::MatrixX3i F_;
    std::vector<int> opposite_;  // `opposite_sides`
    std::vector<bool> core_;     // of each triangle
    std::size_t vertices_;
};

}  // namespace puppetwarp
