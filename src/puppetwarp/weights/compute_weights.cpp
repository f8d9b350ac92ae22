#include <puppetwarp/weights/weights.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/weights/bounded_biharmonic.h>
#include <puppetwarp/weights/cage_checks.h>
#include <puppetwarp/weights/cage_coordinates.h>
#include <puppetwarp/weights/l1.h>
#include <puppetwarp/weights/monotonic.h>
#include <puppetwarp/weights/shepard.h>
#include <puppetwarp/weights/weight_domain.h>
#include <puppetwarp/weights/weight_problem.h>

#include <cassert>
#include <cmath>
#include <utility>

namespace puppetwarp {

namespace {

void require_sound(const WeightOptions& options) {
    if (!(options.tolerance > 0) || !std::isfinite(options.tolerance)) {
        throw InvalidInput("tolerance", "must be a number above 0");
    }
    if (options.max_iterations < 1) throw InvalidInput("max_iterations", "must be at least 1");
    if (!(options.l1_budget > 0 && options.l1_budget <= 1)) {
        throw InvalidInput("l1_budget", "must be above 0 and at most 1");
    }
}

WeightSolution solve(const WeightProblem& problem, const WeightOptions& options, Progress& progress) {
    switch (options.kind) {
        case WeightKind::biharmonic:
            return {unbounded_weights(laplacian_energy(problem), problem.conditions), {}, true, 0, {}};
        case WeightKind::bbw: return bounded_biharmonic_weights(problem, options, progress);
        case WeightKind::l1: return l1_weights(problem, options, progress);
        case WeightKind::monotonic: return monotonic_weights(problem, options, progress);
        default: break;
    }
    assert(options.kind == WeightKind::harmonic || options.kind == WeightKind::harmonic_cage);
    return {unbounded_weights(cotangent_stiffness(problem.mesh), problem.conditions), {}, true, 0, {}};
}

// The families that are solved on a mesh.
Weights weights_on_mesh(const TriangleMesh& mesh, const Rig& rig, const WeightOptions& options, Progress& progress) {
    const WeightDomain domain = weight_domain(mesh, rig);
    const WeightProblem problem(domain.mesh, domain.rig);
    WeightSolution solution = solve(problem, options, progress);
    Weights weights;
    weights.columns = problem.conditions.columns;
    weights.warnings = problem.conditions.warnings;
    weights.iterations = solution.iterations;
    weights.converged = solution.converged;
    weights.kkt_residual = solution.kkt_residual;
    weights.fallback = std::move(solution.fallback);
    weights.W = domain.carry ? Eigen::MatrixXd(*domain.carry * solution.W) : std::move(solution.W);
    return weights;
}

}  // namespace

std::string column_name(const Rig& rig, const WeightColumn& column) {
    const std::string& id = rig.handles[static_cast<std::size_t>(column.handle)].id;
    return column.corner < 0 ? id : id + "[" + std::to_string(column.corner) + "]";
}

Weights compute_weights(const TriangleMesh& mesh, const Rig& rig, const WeightOptions& options, Progress& progress) {
    require_sound(options);
    require_sound(mesh, "mesh");
    require_sound(rig);
    if (rig.handles.empty()) throw InvalidInput("rig", "has no handles", "add points, bones, regions or a cage");
    if (options.kind == WeightKind::harmonic_cage) require_a_cage(rig);
    progress.step("weights", 0);
    Weights weights;
    if (is_closed_form(options.kind)) {
        weights = cage_coordinates(mesh, rig, options.kind);
    } else if (options.kind == WeightKind::shepard) {
        // What holds nothing of the mesh is refused in every kind.
        const WeightDomain domain = weight_domain(mesh, rig);
        const WeightProblem problem(domain.mesh, domain.rig);
        weights.columns = problem.conditions.columns;
        weights.W = shepard_weights(mesh, rig);
    } else {
        weights = weights_on_mesh(mesh, rig, options, progress);
    }
    weights.W.array() += 0.0;  // no -0, which files and reports would show
    weights.partition_error = (weights.W.rowwise().sum().array() - 1).abs().maxCoeff();
    progress.step("weights", 1);
    return weights;
}

}  // namespace puppetwarp
