#include <puppetwarp/deform/local_global.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/deform/arap_energy.h>
#include <puppetwarp/deform/held_quadratic.h>

namespace puppetwarp {

namespace {

using Complex = std::complex<double>;

constexpr const char* user = "arap";

// Who uses the class directly has not passed `make_deformer`.
const TriangleMesh& checked(const TriangleMesh& mesh, const Rig& rig) {
    require_sound(mesh, "mesh");
    require_sound(rig);
    return mesh;
}

QuadraticForm form_of(const Energy& energy) {
    QuadraticForm form;
    form.A = energy.constant_hessian().cast<Complex>();
    form.A.makeCompressed();
    form.product = [&H = energy.constant_hessian()](const Eigen::VectorXcd& x) -> Eigen::VectorXcd { return H * x; };
    return form;
}

}  // namespace

struct ArapLocalGlobal::Parts {
    Parts(const TriangleMesh& mesh_, const Rig& rig_, ArapEnergy energy)
        : mesh(checked(mesh_, rig_)),
          rig(rig_),
          binding(take_hold(mesh, rig, user)),
          arap(make_arap_energy(energy, mesh, triangle_stiffness(mesh, rig.stiffness))),
          quadratic(form_of(*arap), mesh, binding, AffineUse::no) {}

    void require_fits(const Eigen::MatrixX2d& V) const {
        if (V.rows() == mesh.V.rows() && V.allFinite()) return;
        throw InvalidInput("start", "it is not one finite position for each vertex of the mesh");
    }

    TriangleMesh mesh;
    Rig rig;
    Binding binding;
    std::unique_ptr<const Energy> arap;
    HeldQuadratic quadratic;  // refers to arap
};

ArapLocalGlobal::ArapLocalGlobal(const TriangleMesh& mesh, const Rig& rig, ArapEnergy energy)
    : parts_(std::make_unique<const Parts>(mesh, rig, energy)) {}
ArapLocalGlobal::ArapLocalGlobal(ArapLocalGlobal&&) noexcept = default;
ArapLocalGlobal& ArapLocalGlobal::operator=(ArapLocalGlobal&&) noexcept = default;
ArapLocalGlobal::~ArapLocalGlobal() = default;

double ArapLocalGlobal::step(const Pose& pose, Eigen::MatrixX2d& V) const {
    parts_->require_fits(V);
    const Targets targets = resolve(parts_->binding, parts_->mesh, parts_->rig, pose, AffineUse::no, user);
    const HeldGoals goals = parts_->quadratic.goals_of(targets, complex_positions(parts_->mesh.V), true);
    Eigen::VectorXcd x = complex_positions(V);
    // With the rotations held, the energy is quadratic with the constant Hessian H, and its gradient is the energy's
    // own: the step to its minimum is -H^-1 gradient.
    Eigen::VectorXcd gradient;
    parts_->arap->gradient(x, gradient);
    const Eigen::VectorXcd load = -gradient;
    parts_->quadratic.step(goals, &load, x);
    parts_->quadratic.require_met(goals, x, pose.name);
    V = point_positions(x);
    return parts_->arap->value(x);
}

double ArapLocalGlobal::energy(const Eigen::MatrixX2d& V) const {
    parts_->require_fits(V);
    return parts_->arap->value(complex_positions(V));
}

}  // namespace puppetwarp
