#pragma once

#include "reference/dense_field.h"
#include "reference/test_meshes.h"

#include <puppetwarp/deform/deformer.h>

#include <functional>
#include <memory>
#include <vector>

// What the tests of displacement fields share.
namespace puppetwarp::testing_fields {

std::unique_ptr<Deformer> made(Method method, const TriangleMesh& mesh, const Rig& rig);
Deformation deformed(const MethodOptions& options, const TriangleMesh& mesh, const Rig& rig, const Pose& pose);
Deformation deformed(Method method, const TriangleMesh& mesh, const Rig& rig, const Pose& pose);

//! Adds vertex handles to a rig, and to a pose where they go: all to `to`.
void hold_vertices(const std::vector<int>& vertices, const Eigen::RowVector2d& to, Rig& rig, Pose& pose);

//! Positions that the dense reference finds for the rig's holds; `scale` alone is not understood.
Eigen::MatrixX2d dense_answer(const reference::DenseEnergy& energy, const TriangleMesh& mesh, const Rig& rig,
                              const Pose& pose);

}  // namespace puppetwarp::testing_fields
