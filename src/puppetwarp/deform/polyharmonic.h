#pragma once
// Private header.

#include <puppetwarp/deform/deformer.h>

namespace puppetwarp {

//! `harmonic`, `biharmonic`, `triharmonic`, `tetraharmonic`: orders 1 to 4. The displacement u of least
//! u^H L (M^-1 L)^(order - 1) u that meets the handles (DisplacementField), with every row of L, as libigl's.
//! Botsch & Kobbelt 2004, Jacobson et al. 2010. Deviation: the powers of L are never multiplied out, see FieldInverse.
//! Stiffness enters `harmonic` alone: the other energies are of higher order.
//! \throw InvalidInput  as `make_deformer`.
std::unique_ptr<Deformer> make_polyharmonic(int order, const TriangleMesh& mesh, const Rig& rig);

}  // namespace puppetwarp
