#include <puppetwarp/deform/multiresolution.h>

#include <puppetwarp/deform/reference_motion.h>
#include <puppetwarp/deform/smooth_base.h>
#include <puppetwarp/mesh/operators.h>

#include <cmath>

namespace puppetwarp {

namespace {

using Complex = std::complex<double>;

// The turn of a vertex is that of so many rings of triangles: one that the base crushed has none of its own.
constexpr int rings = 3;

// M^-1/2 L with every row, so that |B u|^2 is the biharmonic energy. A vertex of no triangle has no mass.
QuadraticForm::Matrix biharmonic_root(const TriangleMesh& mesh) {
    const Eigen::VectorXd M = lumped_mass(mesh);
    Eigen::VectorXd root = Eigen::VectorXd::Zero(M.size());
    for (Eigen::Index v = 0; v < M.size(); ++v) {
        if (M(v) > 0) root(v) = 1 / std::sqrt(M(v));
    }
    const SparseMatrix B = root.asDiagonal() * cotangent_stiffness(mesh);
    return B.cast<Complex>();
}

}  // namespace

MultiresolutionDeformer::MultiresolutionDeformer(const MethodOptions& options, const TriangleMesh& mesh, const Rig& rig)
    : options_(options),
      mesh_(mesh),
      rig_(rig),
      rest_(complex_positions(mesh.V)),
      size_(bounding_diagonal(mesh.V)),
      component_(vertex_components(mesh)),
      detail_(detail_over_smooth_base(mesh, default_disc_share * size_)),
      base_(rest_ - detail_),
      ring_areas_(ring_maps(base_)),
      binding_(take_hold(mesh, rig, method_name(Method::multiresolution))),
      B_(biharmonic_root(mesh)),
      quadratic_(squared_norm(B_, QuadraticForm::NullSpace::translations), mesh, binding_, AffineUse::no) {}

// Sum over the triangles around each vertex of signed area times f_z of the map from the base, times 4: needs no
// division by areas, so that triangles which the base crushed do no harm.
Eigen::VectorXcd MultiresolutionDeformer::ring_maps(const Eigen::VectorXcd& moved) const {
    Eigen::VectorXcd map = Eigen::VectorXcd::Zero(mesh_.F.rows());
    for (Eigen::Index t = 0; t < mesh_.F.rows(); ++t) {
        for (int k = 1; k < 3; ++k) {
            const Complex edge = base_(mesh_.F(t, (k + 2) % 3)) - base_(mesh_.F(t, (k + 1) % 3));
            const Complex move = moved(mesh_.F(t, k)) - moved(mesh_.F(t, 0));
            // conj(i edge) move
            map(t) += Complex(edge.real() * move.imag() - edge.imag() * move.real(),
                              -edge.real() * move.real() - edge.imag() * move.imag());
        }
    }
    Eigen::VectorXcd sum;
    for (int ring = 0; ring < rings; ++ring) {
        sum = Eigen::VectorXcd::Zero(moved.size());
        for (Eigen::Index t = 0; t < mesh_.F.rows(); ++t) {
            for (int k = 0; k < 3; ++k) sum(mesh_.F(t, k)) += map(t);
        }
        for (Eigen::Index t = 0; t < mesh_.F.rows() && ring + 1 < rings; ++t) {
            map(t) = sum(mesh_.F(t, 0)) + sum(mesh_.F(t, 1)) + sum(mesh_.F(t, 2));
        }
    }
    return sum;
}

Deformation MultiresolutionDeformer::deform(const Pose& pose, const Eigen::MatrixX2d*, Progress& progress) const {
    const Targets targets = resolve(binding_, mesh_, rig_, pose, AffineUse::no, method_name(Method::multiresolution));
    const HeldGoals goals = quadratic_.goals_of(targets, rest_, false);
    const ReferenceMotion rigid(MotionKind::rigid, binding_, targets, component_, rest_);
    Eigen::VectorXcd turn(rest_.size());
    for (int v = 0; v < rest_.size(); ++v) turn(v) = rigid.turn(v);
    const Eigen::VectorXcd moved_rest = rigid.applied(rest_);
    const Eigen::VectorXcd moved_base = moved_rest - turn.cwiseProduct(detail_);

    Deformation result;
    result.converged = false;
    Eigen::VectorXcd u = Eigen::VectorXcd::Zero(rest_.size());
    Eigen::VectorXcd x = moved_rest;
    while (!result.converged && result.iterations < options_.max_iterations) {
        progress.step("deform", static_cast<double>(result.iterations) / options_.max_iterations);
        const Eigen::VectorXcd before = x;
        x = moved_base + u + turn.cwiseProduct(detail_);
        const Eigen::VectorXcd unmet = x;
        quadratic_.step(goals, nullptr, x);
        u += x - unmet;
        const Eigen::VectorXcd map = ring_maps(moved_base + u);
        for (Eigen::Index v = 0; v < x.size(); ++v) {
            // The base's own areas tell the sign, also of a clockwise mesh.
            const Complex direction = map(v) * ring_areas_(v).real();
            const double length = std::abs(direction);
            if (length > 0) turn(v) = direction / length;
        }
        ++result.iterations;
        result.converged = (x - before).lpNorm<Eigen::Infinity>() <= options_.tolerance * size_;
    }
    result.V = point_positions(x);
    result.max_handle_error_px = quadratic_.require_met(goals, x, pose.name);
    result.energy = (B_ * u).squaredNorm();
    result.energy_history = {result.energy};
    result.warnings = binding_.warnings;
    return result;
}

}  // namespace puppetwarp
