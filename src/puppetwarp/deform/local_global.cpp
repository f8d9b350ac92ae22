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

QuadraticForm form_of(const ArapCells& cells) {
    QuadraticForm form;
    form.A = cells.K().cast<Complex>();
    form.A.makeCompressed();
    form.product = [&K = cells.K()](const Eigen::VectorXcd& x) -> Eigen::VectorXcd { return K * x; };
    return form;
}

}  // namespace

struct ArapLocalGlobal::Parts {
    Parts(const TriangleMesh& mesh_, const Rig& rig_, ArapEnergy energy)
        : mesh(checked(mesh_, rig_)),
          rig(rig_),
          binding(take_hold(mesh, rig, user)),
          cells(mesh, energy, triangle_stiffness(mesh, rig.stiffness)),
          quadratic(form_of(cells), mesh, binding, AffineUse::no) {}

    void require_fits(const Eigen::MatrixX2d& V) const {
        if (V.rows() == mesh.V.rows() && V.allFinite()) return;
        throw InvalidInput("start", "it is not one finite position for each vertex of the mesh");
    }

    TriangleMesh mesh;
    Rig rig;
    Binding binding;
    ArapCells cells;
    HeldQuadratic quadratic;  // refers to cells
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
    // With the rotations held, the energy is x^H K x - 2 Re(b^H x) + constant and its gradient 2 (K x - b): the step to
    // its minimum is -K^-1 gradient / 2.
    Eigen::VectorXcd gradient;
    parts_->cells.gradient(x, gradient);
    const Eigen::VectorXcd load = -gradient / 2;
    parts_->quadratic.step(goals, &load, x);
    parts_->quadratic.require_met(goals, x, pose.name);
    V = point_positions(x);
    return parts_->cells.energy(x);
}

double ArapLocalGlobal::energy(const Eigen::MatrixX2d& V) const {
    parts_->require_fits(V);
    return parts_->cells.energy(complex_positions(V));
}

}  // namespace puppetwarp
