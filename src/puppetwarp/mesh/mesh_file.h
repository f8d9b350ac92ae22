#pragma once

#include <puppetwarp/mesh/triangle_mesh.h>

#include <filesystem>

namespace puppetwarp {

//! Reads triangles from OFF or OBJ by the extension: the first two coordinates of each vertex, polygons of more than
//! three corners as fans; texture coordinates, normals, groups and materials are passed over.
//! \throw InvalidInput  unreadable, not such a file (names the line), `require_sound`.
TriangleMesh read_mesh(const std::filesystem::path& path);

//! Writes OFF or OBJ by the extension, z = 0, 17 significant digits, whole or not at all.
//! \param texture  #V x 2 texture coordinates of the vertices (`texture_coordinates`), for OBJ; of no rows: none.
//! \throw InvalidInput  unknown extension, folder missing or read-only, not one texture coordinate for each vertex.
//! \throw MachineFault  disk full.
void write_mesh(const TriangleMesh& mesh, const std::filesystem::path& path, const Eigen::MatrixX2d& texture = {});

//! Where positions lie in a picture of `width` x `height` pixels, as 3D programs count it: (0, 0) is the lower left
//! corner of the picture, (1, 1) the upper right. \param V  #V x 2, pixels, y down.
Eigen::MatrixX2d texture_coordinates(const Eigen::MatrixX2d& V, double width, double height);

//! The part of image space that a drawing shows.
struct DrawingArea {
    double x = 0;
    double y = 0;
    double width = 0;
    double height = 0;
    double scale = 1;  //!< pixels of the drawing for one of image space
};

//! Writes an SVG drawing of the edges. Errors as `write_mesh`.
void write_mesh_svg(const TriangleMesh& mesh, const DrawingArea& area, const std::filesystem::path& path);

}  // namespace puppetwarp
