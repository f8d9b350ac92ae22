#pragma once

#include <puppetwarp/mesh/mesh_file.h>

#include <string>
#include <string_view>

namespace puppetwarp {

//! Triangles from the text of an OFF file: OFF, COFF, NOFF, STOFF and their combinations with three coordinates.
//! \param subject  what to call the file in messages.
//! \throw InvalidInput  not such a text (names the line), an index out of range, a coordinate that is not finite.
TriangleMesh mesh_from_off(std::string_view text, const std::string& subject);

//! Triangles from the text of an OBJ file. Negative indices count from the last vertex. Errors as `mesh_from_off`.
TriangleMesh mesh_from_obj(std::string_view text, const std::string& subject);

std::string off_from_mesh(const TriangleMesh& mesh);
//! \param texture  #V x 2 texture coordinates, or of no rows: none are written.
std::string obj_from_mesh(const TriangleMesh& mesh, const Eigen::MatrixX2d& texture = {});

//! An SVG drawing of the edges.
std::string svg_from_mesh(const TriangleMesh& mesh, const DrawingArea& area);

}  // namespace puppetwarp
