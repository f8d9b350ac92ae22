#pragma once

#include <puppetwarp/base/point.h>
#include <puppetwarp/mesh/triangle_mesh.h>

#include <memory>

namespace puppetwarp {

//! Where a point lies in a mesh.
struct MeshLocation {
    int triangle = -1;  //!< index of the triangle that holds the point, or the nearest one
    //! Weights of its corners, in [0, 1], sum 1; of the nearest point when outside.
    Eigen::Vector3d barycentric = Eigen::Vector3d::Zero();
    double distance_px = 0;  //!< how far the point is from the mesh; 0 inside
};

//! Finds the triangle at a point; built once, then about constant time a query inside the mesh.
class MeshLocator {
public:
    //! Keeps copies of what it needs.
    explicit MeshLocator(const TriangleMesh& mesh);
    ~MeshLocator();
    MeshLocator(MeshLocator&&) noexcept;
    MeshLocator& operator=(MeshLocator&&) noexcept;

    //! \pre the mesh has a triangle. Ties go to the lowest triangle index.
    MeshLocation locate(const Point& point) const;

private:
    struct Grid;
    std::unique_ptr<Grid> grid_;
};

}  // namespace puppetwarp
