#include <puppetwarp/deform/laplacian_linear.h>

#include <puppetwarp/deform/reference_motion.h>

namespace puppetwarp {

namespace {

// The second takes away what the condition of the normal equations costs.
constexpr int passes = 2;

}  // namespace

LinearLaplacianDeformer::LinearLaplacianDeformer(Method method, const TriangleMesh& mesh, const Rig& rig)
    : method_(method),
      mesh_(mesh),
      rig_(rig),
      rest_(complex_positions(mesh.V)),
      component_(vertex_components(mesh)),
      binding_(take_hold(mesh, rig, method_name(method))),
      energy_(similar() ? similarity_laplacian_energy(mesh, triangle_stiffness(mesh, rig.stiffness))
                        : laplacian_energy(mesh, triangle_stiffness(mesh, rig.stiffness))),
      quadratic_(squared_norm(energy_.B, similar() ? QuadraticForm::NullSpace::similarities
                                                   : QuadraticForm::NullSpace::translations),
                 mesh, binding_, affine()) {}

Deformation LinearLaplacianDeformer::deform(const Pose& pose, const Eigen::MatrixX2d*, Progress& progress) const {
    progress.step("deform", 0);
    const Targets targets = resolve(binding_, mesh_, rig_, pose, affine(), method_name(method_));
    const HeldGoals goals = quadratic_.goals_of(targets, rest_, similar());
    // Starting from what costs nothing leaves less to round-off, and only held vertices bring a load.
    const MotionKind kind = similar() ? MotionKind::similarity : MotionKind::translation;
    Eigen::VectorXcd x = ReferenceMotion(kind, binding_, targets, component_, rest_).applied(rest_);
    quadratic_.step(goals, nullptr, x, passes);
    Deformation result;
    result.V = point_positions(x);
    result.max_handle_error_px = quadratic_.require_met(goals, x, pose.name);
    result.energy = energy_(x);
    result.energy_history = {result.energy};
    result.warnings = binding_.warnings;
    return result;
}

}  // namespace puppetwarp
