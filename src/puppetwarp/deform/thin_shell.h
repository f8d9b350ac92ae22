#pragma once
// Private header.

#include <puppetwarp/deform/deformer.h>

namespace puppetwarp {

//! `thin-shell`: the displacement u of least k_s u^H L u + k_b u^H L M^-1 L u that meets the handles
//! (DisplacementField), whose Euler-Lagrange equation is -k_s Lap u + k_b Lap^2 u = 0.   Botsch & Sorkine 2008.
//! k_s = options.stretching, k_b = options.bending times the squared bounding diagonal. Without bending it is
//! `harmonic`, without stretching `biharmonic`. Stiffness multiplies the stretching alone.
//! \throw InvalidInput  a weight below 0 or not finite, or both 0; else as `make_deformer`.
std::unique_ptr<Deformer> make_thin_shell(const MethodOptions& options, const TriangleMesh& mesh, const Rig& rig);

}  // namespace puppetwarp
