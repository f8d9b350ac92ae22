#include <puppetwarp/deform/variational.h>

#include <puppetwarp/base/errors.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace puppetwarp {

namespace {

// Energies below this share of the squared size are what round-off makes of none.
constexpr double round_off_energy = 1e-18;
constexpr double round_off_share = 1e-12;
// Handles whose targets are missed by more than this share of the subject's size contradict each other.
constexpr double contradiction = 1e-6;
// A disc that shrank to this share of its size counts as crushed.
constexpr double crushed = 0.1;
// On the way, coming near to the minimum is enough.
constexpr double loose_tolerance = 1e-2;
constexpr int loose_iterations = 12;
// A stride that took more iterations has outrun the factor.
constexpr int patience = 3;
// Turns below are the same by any way.
constexpr double far_turn_rad = 1.0;
// A constant metric is given up for the true one after this many iterations.
constexpr int constant_iterations = 80;
// A scale alone is met when its direction has settled to this share.
constexpr double settled_scale = 1e-10;
constexpr int most_rounds = 20;

}  // namespace

VariationalDeformer::VariationalDeformer(const MethodOptions& options, const TriangleMesh& mesh, const Rig& rig)
    : problem_(options, mesh, rig) {}

// Leads the handles from where x has them to the goals, and ends in a minimum there.
VariationalDeformer::Outcome VariationalDeformer::lead(const Eigen::VectorXcd& start, const Goals& goals, bool spirals,
                                                       Progress& progress) const {
    const double floor = round_off_energy * problem_.size() * problem_.size();
    const MethodOptions& options = problem_.options();
    const GoalPath path(problem_.binding(), goals_at(start, problem_.binding(), goals), goals, problem_.size(), spirals);
    const int strides = path.strides();
    Eigen::VectorXcd x = start;
    Objective objective = problem_.objective(path.at(1.0 / strides), x);
    std::shared_ptr<ConstrainedMetric> metric;
    std::shared_ptr<const ConstrainedMetric> last_metric;
    Descent descent(objective, std::move(x));
    bool slow = false;
    int spent = 0;
    Minimum minimum;
    for (int s = 1; s <= strides; ++s) {
        const bool last = s == strides;
        const Goals here = path.at(static_cast<double>(s) / strides);
        for (int round = 0;; ++round) {
            Eigen::VectorXcd placed = descent.x();
            problem_.place_held(here, placed);
            problem_.aim(objective, here, placed);
            descent.restart_at(std::move(placed));
            if (!metric || slow) {
                metric = problem_.metric(descent.x(), objective);
                descent.forget();
            } else {
                problem_.choose(*metric, objective);
            }
            descent.meet_conditions(*metric);
            const int budget = std::max(0, options.max_iterations - spent);
            const StopRule rule{last ? options.tolerance : loose_tolerance,
                                last ? budget : std::min(budget, loose_iterations), floor};
            const MetricMaker renewed = [&](const Eigen::VectorXcd& at) {
                metric = problem_.constant_metric() && minimum_is_young(descent) ? problem_.metric(at, objective)
                                                                                 : problem_.exact_metric(at, objective);
                return metric;
            };
            last_metric = metric;
            minimum = minimise(descent, last_metric, renewed, rule, progress);
            spent += minimum.iterations;
            slow = minimum.iterations > patience && !problem_.constant_metric();
            if (!last) break;
            descent.polish_conditions(*last_metric);
        }
    }
    minimum.iterations = spent;
    return {descent.x(), std::move(minimum)};
}

}  // namespace puppetwarp
