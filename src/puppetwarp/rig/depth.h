#pragma once

#include <puppetwarp/mesh/triangle_mesh.h>
#include <puppetwarp/rig/rig.h>

namespace puppetwarp {

//! How near to the viewer a pose brings each vertex.
//!
//! Handles hold the depths that the pose gives them: points the vertices of their discs, bones those of discs along
//! themselves, regions and cages the vertices inside, vertices themselves. A handle without one holds depth 0, so that
//! an arm is brought forward by its hand alone; but a bone without one is as deep as its parent, and a cage without one
//! holds nothing. What two handles hold is the one's that the pose gives a depth, else the earlier one's. Between them
//! depth is harmonic over the mesh, and a component that is held at one depth alone, or not at all (0), has it
//! everywhere. It depends on nothing but depths and the shape at rest.
//! \pre require_sound(rig), require_sound(pose, rig).
//! \return #V, larger is nearer; empty when the pose gives no handle a depth: all is alike.
//! \throw InvalidInput  triangles too bad to compute with.
Eigen::VectorXd vertex_depths(const TriangleMesh& mesh, const Rig& rig, const Pose& pose);

}  // namespace puppetwarp
