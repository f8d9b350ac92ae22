#include <puppetwarp/deform/arap_energy.h>

#include <puppetwarp/deform/arap_cells.h>
#include <puppetwarp/deform/element_energy.h>

namespace puppetwarp {

std::unique_ptr<Energy> make_arap_energy(ArapEnergy energy, const TriangleMesh& mesh,
                                         const Eigen::VectorXd& stiffness) {
    if (energy == ArapEnergy::elements) return make_element_arap(mesh, stiffness);
    return std::make_unique<ArapCells>(mesh, energy, stiffness);
}

}  // namespace puppetwarp
