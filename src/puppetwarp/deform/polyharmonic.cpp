#include <puppetwarp/deform/polyharmonic.h>

#include <puppetwarp/deform/displacement_field.h>

#include <array>
#include <cassert>

namespace puppetwarp {

std::unique_ptr<Deformer> make_polyharmonic(int order, const TriangleMesh& mesh, const Rig& rig) {
    assert(order >= 1 && order <= 4);
    constexpr std::array<Method, 4> methods{Method::harmonic, Method::biharmonic, Method::triharmonic,
                                            Method::tetraharmonic};
    const auto energy_of = [order](const TriangleMesh& on, const Eigen::VectorXd& stiffness) {
        FieldEnergy energy;
        energy.order = order;
        energy.L = cotangent_stiffness(on, order == 1 ? stiffness : Eigen::VectorXd());
        energy.M = lumped_mass(on);
        return energy;
    };
    return std::make_unique<DisplacementField>(methods[static_cast<std::size_t>(order) - 1], energy_of, mesh, rig);
}

}  // namespace puppetwarp
