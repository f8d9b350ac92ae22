#pragma once
// Private header.

#include <puppetwarp/mesh/operators.h>
#include <puppetwarp/rig/rig.h>

#include <optional>

namespace puppetwarp {

//! The mesh on which weights are solved: the subject's own, or a larger one where a cage is not made of its edges.
struct WeightDomain {
    TriangleMesh mesh;
    //! #V x #V of `mesh`: carries what was solved to the subject's vertices, its rows are barycentric coordinates; none
    //! where `mesh` is the subject's own.
    std::optional<SparseMatrix> carry;
};

//! \pre require_sound(mesh, ...), require_sound(rig).
//! \throw InvalidInput  a cage crosses itself or holds nothing of the mesh.
WeightDomain weight_domain(const TriangleMesh& mesh, const Rig& rig);

}  // namespace puppetwarp
