#pragma once
// Private header.

#include <puppetwarp/mesh/operators.h>
#include <puppetwarp/rig/rig.h>

#include <optional>

namespace puppetwarp {

//! The mesh on which weights are solved: the subject's own where there is no cage or every cage is made of its edges
//! and full of its triangles, else a larger one, of all that the subject or a cage holds, whose edges run along the
//! cages. Within a cage the subject's boundary and holes are no more: there, weights know the shape of the cage.
struct WeightDomain {
    TriangleMesh mesh;
    Rig rig;  //!< the same handles; vertices by their indices in `mesh`
    //! #V x #V of `mesh`: carries what was solved to the subject's vertices. Nearly all are vertices of `mesh` too;
    //! rows of the others are barycentric coordinates. None where `mesh` is the subject's own.
    std::optional<SparseMatrix> carry;
};

//! \pre require_sound(mesh, ...), require_sound(rig).
//! \throw InvalidInput  see `require_sound_cages`; an index of a vertex handle out of range.
WeightDomain weight_domain(const TriangleMesh& mesh, const Rig& rig);

}  // namespace puppetwarp
