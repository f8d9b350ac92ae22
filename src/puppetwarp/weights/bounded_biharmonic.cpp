#include <puppetwarp/weights/bounded_biharmonic.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/solve/box_qp.h>
#include <puppetwarp/solve/simplex_qp.h>
#include <puppetwarp/weights/coarse_levels.h>
#include <puppetwarp/weights/row_sums.h>

#include <algorithm>
#include <optional>
#include <utility>

namespace puppetwarp {

namespace {

// What is carried from a coarse mesh and below this is taken for 0. Tails of weights are that thin for long; started
// without them an active set needs more rounds to grow them again, started with more it has larger systems to solve.
constexpr double support_threshold = 1e-6;
// Coarse meshes only have to tell which weights are 0.
constexpr double coarse_tolerance = 1e-5;

[[noreturn]] void refuse_triangles() {
    throw InvalidInput("mesh", "its triangles are too thin or too different in size to compute weights with",
                       "use a mesh with better triangles");
}

// A guess as a start for active sets: what is near a bound is at it.
template <typename Matrix>
void snap_to_bounds(Matrix& W) {
    W = (W.array() < support_threshold).select(0.0, W);
    W = (W.array() > 1 - support_threshold).select(1.0, W);
}

void add(WeightSolution& all, const QpReport& part) {
    all.iterations += part.iterations;
    all.converged = all.converged && part.converged;
    all.kkt_residual = std::max(all.kkt_residual, part.kkt_residual);
    if (part.safeguarded) all.fallback = "projected Newton";
}

// Solves one level after the other. `report(share)` takes what share of a level's work is done.
class LevelSolver {
public:
    LevelSolver(const WeightOptions& options, Progress& progress) : options_(options), progress_(progress) {}

    //! Of the coarse levels only the iterations count: the last has the answer.
    WeightSolution run(const WeightProblem& problem) {
        const std::vector<CoarseLevel> levels = coarse_levels(problem);
        double work = 0;
        for (const CoarseLevel& level : levels) work += work_of(level.problem);
        total_ = work + work_of(problem);
        std::optional<Eigen::MatrixXd> guess;
        int iterations = 0;
        for (std::size_t k = levels.size(); k-- > 0;) {
            const WeightSolution coarse = solve(levels[k].problem, guess);
            iterations += coarse.iterations;
            guess = levels[k].carry * coarse.W;
        }
        fine_ = true;
        WeightSolution solution = solve(problem, guess);
        solution.iterations += iterations;
        return solution;
    }

private:
    static double work_of(const WeightProblem& problem) { return static_cast<double>(problem.mesh.V.rows()); }

    WeightSolution solve(const WeightProblem& problem, const std::optional<Eigen::MatrixXd>& guess) {
        const SparseMatrix Q = laplacian_energy(problem);
        WeightSolution solution;
        if (options_.partition == Partition::normalised) {
            solution = solve_each(Q, problem, guess ? *guess : unbounded_weights(Q, problem.conditions), {0, 1});
        } else if (guess) {
            solution = solve_coupled(Q, problem, *guess, {0, 1});
        } else {
            // Each handle on its own says nearly which weights are 0. Unbounded weights are everywhere above or below
            // it: what a system of all that are above costs grows with the cube of the number of handles.
            constexpr double share = 0.3;
            const WeightSolution each = solve_each(Q, problem, unbounded_weights(Q, problem.conditions), {0, share});
            solution = solve_coupled(Q, problem, each.W, {share, 1 - share});
            solution.iterations += each.iterations;
        }
        done_ += work_of(problem);
        return solution;
    }

    // Part of the work on a problem: what was done before it, and its own share.
    struct Part {
        double before, share;
    };

    // One step of progress a factorisation; how many there will be is unknown.
    QpOptions qp_options(const WeightProblem& problem, const Part& part) {
        const double tolerance = fine_ ? options_.tolerance : std::max(coarse_tolerance, options_.tolerance);
        const double first = (done_ + part.before * work_of(problem)) / total_;
        const double width = part.share * work_of(problem) / total_;
        return {tolerance, options_.max_iterations, [this, first, width, steps = 0]() mutable {
                    progress_.step("weights", first + width * (1 - 1 / (1 + 0.5 * steps++)));
                }};
    }

    // What is given, as it is; else what is near a bound is at it.
    static Eigen::MatrixXd start_from(Eigen::MatrixXd W, const WeightConditions& conditions) {
        snap_to_bounds(W);
        for (std::size_t i = 0; i < conditions.vertices.size(); ++i) {
            W.row(conditions.vertices[i]) = conditions.values.row(static_cast<Eigen::Index>(i));
        }
        return W;
    }

    WeightSolution solve_coupled(const SparseMatrix& Q, const WeightProblem& problem, const Eigen::MatrixXd& guess,
                                 const Part& part) {
        std::vector<char> given(static_cast<std::size_t>(Q.rows()), 0);
        for (const int v : problem.conditions.vertices) given[static_cast<std::size_t>(v)] = 1;
        const Eigen::MatrixXd start = start_from(guess, problem.conditions);
        const auto found = solve_simplex_qp({Q, given}, start, qp_options(problem, part));
        if (!found) refuse_triangles();
        WeightSolution solution;
        add(solution, *found);
        solution.W = found->W;
        return solution;
    }

    WeightSolution solve_each(const SparseMatrix& Q, const WeightProblem& problem, const Eigen::MatrixXd& guess,
                              const Part& part) {
        const Eigen::MatrixXd start = start_from(guess, problem.conditions);
        WeightSolution solution;
        solution.W.resize(start.rows(), start.cols());
        const Eigen::VectorXd c = Eigen::VectorXd::Zero(Q.rows());
        const double share = part.share / static_cast<double>(start.cols());
        for (Eigen::Index j = 0; j < start.cols(); ++j) {
            Eigen::VectorXd lower = Eigen::VectorXd::Zero(Q.rows());
            Eigen::VectorXd upper = Eigen::VectorXd::Ones(Q.rows());
            for (const int v : problem.conditions.vertices) lower(v) = upper(v) = start(v, j);
            const QpOptions options = qp_options(problem, {part.before + static_cast<double>(j) * share, share});
            const auto found = solve_box_qp({Q, c, lower, upper}, start.col(j), options);
            if (!found) refuse_triangles();
            add(solution, *found);
            solution.W.col(j) = found->x;
        }
        return solution;
    }

    const WeightOptions& options_;
    Progress& progress_;
    double total_ = 1, done_ = 0;
    bool fine_ = false;  // whether at the mesh that was asked for
};

}  // namespace

WeightSolution bounded_biharmonic_weights(const WeightProblem& problem, const WeightOptions& options,
                                          Progress& progress) {
    WeightSolution solution = LevelSolver(options, progress).run(problem);
    divide_by_row_sums(problem.mesh, solution.W);
    return solution;
}

WeightSolution bounded_biharmonic_functions(const WeightProblem& problem, const WeightOptions& options,
                                            Progress& progress) {
    WeightOptions each = options;
    each.partition = Partition::normalised;
    return LevelSolver(each, progress).run(problem);
}

}  // namespace puppetwarp
