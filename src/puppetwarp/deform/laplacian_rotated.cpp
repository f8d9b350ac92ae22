#include <puppetwarp/deform/laplacian_rotated.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/deform/anderson.h>
#include <puppetwarp/deform/reference_motion.h>

#include <cmath>

namespace puppetwarp {

namespace {

// A turn is estimated over a vertex's neighbours and so many rings more: one ring that handles crushed has none of its
// own.
constexpr int wider = 2;

}  // namespace

RotatedLaplacianDeformer::RotatedLaplacianDeformer(const MethodOptions& options, const TriangleMesh& mesh,
                                                   const Rig& rig)
    : options_(options),
      mesh_(mesh),
      rig_(rig),
      rest_(complex_positions(mesh.V)),
      size_(bounding_diagonal(mesh.V)),
      component_(vertex_components(mesh)),
      neighbours_(neighbours_of(mesh)),
      binding_(take_hold(mesh, rig, method_name(Method::laplacian_rotated))),
      energy_(laplacian_energy(mesh, triangle_stiffness(mesh, rig.stiffness))),
      quadratic_(squared_norm(energy_.B, QuadraticForm::NullSpace::translations), mesh, binding_, AffineUse::no) {}

// How each vertex's neighbourhood turned from rest to x: the rotation alone.
Eigen::VectorXcd RotatedLaplacianDeformer::turned(const Eigen::VectorXcd& x, const Eigen::VectorXcd& otherwise) const {
    Eigen::VectorXcd correlation = Eigen::VectorXcd::Zero(x.size());
    for (int i = 0; i < x.size(); ++i) {
        for (const int j : neighbours_[static_cast<std::size_t>(i)]) {
            correlation(i) += std::conj(rest_(j) - rest_(i)) * (x(j) - x(i));
        }
    }
    for (int pass = 0; pass < wider; ++pass) {
        Eigen::VectorXcd sum = correlation;
        for (int i = 0; i < x.size(); ++i) {
            for (const int j : neighbours_[static_cast<std::size_t>(i)]) sum(i) += correlation(j);
        }
        correlation = sum;
    }
    Eigen::VectorXcd turn(x.size());
    for (Eigen::Index i = 0; i < x.size(); ++i) {
        const double length = std::abs(correlation(i));
        turn(i) = length > 0 ? correlation(i) / length : otherwise(i);
    }
    return turn;
}

void RotatedLaplacianDeformer::solve(const HeldGoals& goals, const Eigen::VectorXcd& turn, Eigen::VectorXcd& x) const {
    const Eigen::VectorXcd missing = energy_.target.cwiseProduct(turn) - energy_.B * x;
    const Eigen::VectorXcd load = energy_.B.adjoint() * missing;
    quadratic_.step(goals, &load, x);
}

Deformation RotatedLaplacianDeformer::deform(const Pose& pose, const Eigen::MatrixX2d* start,
                                             Progress& progress) const {
    if (start != nullptr && (start->rows() != rest_.size() || !start->allFinite())) {
        throw InvalidInput("start", "it is not one finite position for each vertex of the mesh");
    }
    const Targets targets = resolve(binding_, mesh_, rig_, pose, AffineUse::no, method_name(Method::laplacian_rotated));
    const HeldGoals goals = quadratic_.goals_of(targets, rest_, true);
    const ReferenceMotion rigid(MotionKind::rigid, binding_, targets, component_, rest_);
    Eigen::VectorXcd x = rigid.applied(rest_);
    Eigen::VectorXcd turn(x.size());
    for (int v = 0; v < x.size(); ++v) turn(v) = rigid.turn(v);
    if (start != nullptr) turn = turned(complex_positions(*start), turn);

    Deformation result;
    result.converged = false;
    AndersonMixing mixing;
    while (!result.converged && result.iterations < options_.max_iterations) {
        progress.step("deform", static_cast<double>(result.iterations) / options_.max_iterations);
        const Eigen::VectorXcd before = x;
        solve(goals, turn, x);
        ++result.iterations;
        result.converged = (x - before).lpNorm<Eigen::Infinity>() <= options_.tolerance * size_;
        if (!result.converged && result.iterations < options_.max_iterations) {
            x = mixing.next(before, x);
            turn = turned(x, turn);
        }
    }
    const DifferentialEnergy energy{energy_.B, energy_.target.cwiseProduct(turn)};
    result.V = point_positions(x);
    result.max_handle_error_px = quadratic_.require_met(goals, x, pose.name);
    result.energy = energy(x);
    result.energy_history = {result.energy};
    result.warnings = binding_.warnings;
    return result;
}

}  // namespace puppetwarp
