#include <puppetwarp/deform/thin_shell.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/deform/displacement_field.h>

#include <cmath>

namespace puppetwarp {

std::unique_ptr<Deformer> make_thin_shell(const MethodOptions& options, const TriangleMesh& mesh, const Rig& rig) {
    const auto require_weight = [](double weight, const char* name) {
        if (!(weight >= 0) || !std::isfinite(weight)) throw InvalidInput(name, "must be a number of at least 0");
    };
    require_weight(options.stretching, "stretching");
    require_weight(options.bending, "bending");
    const double stretching = options.stretching;
    const double bending = options.bending * std::pow(bounding_diagonal(mesh.V), 2);
    if (stretching == 0 && bending == 0) {
        throw InvalidInput("thin-shell", "stretching and bending are both 0, so nothing resists", "raise one of them");
    }
    const auto energy_of = [=](const TriangleMesh& on, const Eigen::VectorXd& stiffness) {
        FieldEnergy energy;
        energy.order = bending > 0 ? 2 : 1;
        energy.weight = bending > 0 ? bending : stretching;
        energy.L = cotangent_stiffness(on, bending > 0 ? Eigen::VectorXd() : stiffness);
        energy.M = lumped_mass(on);
        if (bending > 0 && stretching > 0) {
            energy.first_order = stretching;
            if (stiffness.size() > 0) energy.K = cotangent_stiffness(on, stiffness);
        }
        return energy;
    };
    return std::make_unique<DisplacementField>(Method::thin_shell, energy_of, mesh, rig);
}

}  // namespace puppetwarp
