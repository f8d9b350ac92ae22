#pragma once

#include <puppetwarp/mesh/triangle_mesh.h>

#include <filesystem>

namespace puppetwarp {

//! Reads triangles from OFF or OBJ by the extension: the first two coordinates of each vertex, polygons of more than
//! three corners as fans; texture coordinates, normals, groups and materials are passed over.
//! \throw InvalidInput  unreadable, not such a file (names the line), `require_sound`.
TriangleMesh read_mesh(const std::filesystem::path& path);

//! Writes OFF or OBJ by the extension, z = 0, 17 significant digits, whole or not at all.
//! \throw InvalidInput  unknown extension, folder missing or read-only.  \throw MachineFault  disk full.
void write_mesh(const TriangleMesh& mesh, const std::filesystem::path& path);

//! Writes an SVG drawing of the edges over `width` x `height` image pixels. Errors as `write_mesh`.
void write_mesh_svg(const TriangleMesh& mesh, int width, int height, const std::filesystem::path& path);

}  // namespace puppetwarp
