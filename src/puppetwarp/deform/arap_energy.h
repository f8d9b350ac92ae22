#pragma once
// Private header.

#include <puppetwarp/deform/deformer.h>
#include <puppetwarp/deform/energy.h>

#include <memory>

namespace puppetwarp {

//! The as-rigid-as-possible energy of a choice: ArapCells, or make_element_arap.
//! \param stiffness  #F factors of each triangle's share, or empty for 1.
std::unique_ptr<Energy> make_arap_energy(ArapEnergy energy, const TriangleMesh& mesh, const Eigen::VectorXd& stiffness);

}  // namespace puppetwarp
