#pragma once

#include <puppetwarp/mesh/outline.h>
#include <puppetwarp/mesh/triangle_mesh.h>
#include <puppetwarp/rig/rig.h>

namespace puppetwarp {

//! Adds `automatic_cage(subject, corners)` as the last handle of a rig, with the id `cage` or, where another handle has
//! it, `cage2`, `cage3`, ... Its corners are rounded to short decimal numbers, by less than a ten-thousandth of the
//! cage's diagonal.
//! \throw InvalidInput  the rig has a cage; `automatic_cage`.
void add_automatic_cage(Rig& rig, const Outline& subject, int corners);
void add_automatic_cage(Rig& rig, const TriangleMesh& subject, int corners);

}  // namespace puppetwarp
