#pragma once

#include <puppetwarp/project/pipeline.h>
#include <puppetwarp/warp/displacement.h>

#include <filesystem>

namespace puppetwarp {

// What a run of `render` leaves for other programs, beside its picture.

//! The map that the picture was drawn with. \param rendered  with `keep_source`.
DisplacementRows displacement_of(const Rendered& rendered, const RenderOptions& options);

//! \throw InvalidInput  a name that is not .off, .obj or .svg.
void require_moved_mesh_name(const std::filesystem::path& path);

//! The moved mesh, in image space: OFF; OBJ with texture coordinates that put the picture onto it (y up, as 3D programs
//! count them; positions y down as everywhere here); or its edges as an SVG drawing that lies over the result.
//! \throw InvalidInput, MachineFault  as `write_mesh`.
void write_moved_mesh(const Rendered& rendered, const std::filesystem::path& path);

}  // namespace puppetwarp
