#include <puppetwarp/deform/variational.h>

#include <puppetwarp/base/errors.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace puppetwarp {

namespace {

using Complex = std::complex<double>;

// Energies below this share of the squared size are what round-off makes of none.
constexpr double round_off_energy = 1e-18;
constexpr double round_off_share = 1e-12;
// Handles whose targets are missed by more than this share of the subject's size contradict each other.
constexpr double contradiction = 1e-6;
// A disc that shrank to this share of its size counts as crushed.
constexpr double crushed = 0.1;
// On the way, coming near to the minimum is enough.
constexpr double loose_tolerance = 1e-3;
constexpr int loose_iterations = 12;
// A stride that took more iterations has outrun the factor.
constexpr int patience = 1;
// The widest turn in one stride, ten degrees: wider ones come to other minima than a hand that drags.
constexpr double stride_rad = 0.1746;
// Turns below are the same by any way.
constexpr double far_turn_rad = 1.0;
constexpr double very_far_turn_rad = 2.0;
// A constant metric is given up for the true one after this many iterations.
constexpr int constant_iterations = 80;
// A fixed scale with a free angle is a curved condition: met in so many rounds of straight ones, or at a fixed angle.
constexpr int most_rounds = 10;
// What another way must be better than the first.
constexpr double better_share = 0.999;
// Arms that come to be shorter than this share of themselves go over something; nearly half a turn brings them back.
constexpr double squeezed = 0.6;
constexpr double turned_over_rad = 2.97;
// Turns that differ by less are the same, whole turns counted.
constexpr double same_turn_rad = 0.01;
// Where the rest pose, moved rigidly, meets the handles it is left only for a state that is turned farther.
constexpr double wound_rad = 0.1;

double unwrapped(double angle, double last) {
    return last + std::remainder(angle - last, 2 * std::numbers::pi);
}

// The turns of free angles whose goals say how far they go, followed in steps below half a turn.
class TurnCount {
public:
    TurnCount(const Binding& binding, const Goals& goals) : binding_(binding), goals_(goals) {
        turns_.resize(goals.holds.size());
    }
    void follow(const Eigen::VectorXcd& x) {
        for (std::size_t h = 0; h < turns_.size(); ++h) {
            if (goals_.holds[h].way_rad)
                turns_[h] = unwrapped(std::arg(row_value(binding_.holds[h].turn, x)), turns_[h]);
        }
    }
    double error() const {
        double largest = 0;
        for (std::size_t h = 0; h < turns_.size(); ++h) {
            if (goals_.holds[h].way_rad) largest = std::max(largest, std::abs(*goals_.holds[h].way_rad - turns_[h]));
        }
        return largest;
    }

private:
    const Binding& binding_;
    const Goals& goals_;
    std::vector<double> turns_;
};

bool says_turns(const Goals& goals) {
    return std::any_of(goals.holds.begin(), goals.holds.end(),
                       [](const HoldGoal& goal) { return goal.way_rad.has_value(); });
}

// Whether the goals say of a free angle that it turned so far that the rest pose, moved rigidly, is another state.
bool are_wound(const Goals& goals, const Eigen::VectorXcd& x, const Binding& binding) {
    TurnCount count(binding, goals);
    count.follow(x);
    return count.error() > wound_rad;
}

}  // namespace

std::unique_ptr<Deformer> VariationalDeformer::with_rig(const Rig& rig) const {
    require_sound(rig);
    return std::make_unique<VariationalDeformer>(std::make_shared<VariationalProblem>(*problem_, rig));
}

// Goals whose given scales have an angle as well, that of x. A disc that is pressed together would rather turn away
// from every straight condition than be small: its angle is kept as it came.
Goals VariationalDeformer::facing_as(const Eigen::VectorXcd& x, Goals goals) const {
    for (std::size_t h = 0; h < goals.holds.size(); ++h) {
        HoldGoal& goal = goals.holds[h];
        if (goal.scale && !goal.angle_rad) goal.angle_rad = std::arg(row_value(problem_->binding().holds[h].turn, x));
    }
    return goals;
}

// Leads the handles from where x has them to the goals, and ends in a minimum there.
VariationalDeformer::Outcome VariationalDeformer::lead(const Eigen::VectorXcd& start, const Goals& goals, Way way,
                                                       int most_iterations, Progress& progress) const {
    const double floor = round_off_energy * problem_->size() * problem_->size();
    const MethodOptions& options = problem_->options();
    const GoalPath path(problem_->binding(), goals_at(start, problem_->binding(), goals), goals, problem_->size(), way);
    const int strides = path.strides(stride_rad);
    TurnCount turns(problem_->binding(), goals);
    turns.follow(start);
    Objective objective = problem_->objective(path.at(1.0 / strides), start);
    Descent descent(objective, start);
    std::shared_ptr<ConstrainedMetric> metric;
    const MetricMaker renewed = [&](const Eigen::VectorXcd& x, int iterations,
                                    bool stuck) -> std::shared_ptr<ConstrainedMetric> {
        if (problem_->constant_metric() && iterations < constant_iterations && !stuck) return nullptr;
        return problem_->exact_metric(x, objective);
    };
    const auto aim = [&](const Goals& here, bool renew) {
        Eigen::VectorXcd x = descent.x();
        problem_->place_held(here, x);
        problem_->aim(objective, here, x);
        descent.restart_at(std::move(x));
        if (!metric || renew) {
            metric = problem_->metric(descent.x(), objective);
            descent.forget();
        } else if (problem_->choose(*metric, objective)) {
            descent.forget();
        }
        descent.meet_conditions(*metric);
    };

    bool slow = false;
    int spent = 0;
    const auto come_near = [&](const Goals& here) {
        aim(here, slow);
        const int budget = std::clamp(most_iterations - spent, 0, loose_iterations);
        const Minimum near = minimise(descent, metric, renewed, {loose_tolerance, budget, floor}, progress);
        spent += near.iterations;
        turns.follow(descent.x());
        slow = near.iterations > patience && !problem_->constant_metric();
    };
    for (int s = 1; s < strides; ++s) come_near(path.at(static_cast<double>(s) / strides));
    if (way == Way::turning && says_turns(goals)) come_near(path.held_end());
    Outcome outcome;
    const Eigen::VectorXcd before = descent.x();
    for (int round = 0; round <= most_rounds; ++round) {
        aim(round < most_rounds ? goals : facing_as(before, goals), slow);
        const int budget = std::max(0, most_iterations - spent);
        outcome.minimum = minimise(descent, metric, renewed, {options.tolerance, budget, floor}, progress);
        spent += outcome.minimum.iterations;
        // Strides add up round-off; the handles are met to the last of it.
        descent.polish_conditions(*metric);
        if (problem_->scales_settled(goals, descent.x())) break;
    }
    outcome.x = descent.x();
    outcome.minimum.iterations = spent;
    outcome.value = descent.value();
    turns.follow(outcome.x);
    outcome.turn_error = turns.error();
    return outcome;
}

// The goals with free angles turned along with their spirals, far turns all in one sense: a limb as a whole. What comes
// so near to its neighbours that it would be crushed on the way is turned over.
Goals VariationalDeformer::turned_by(const Eigen::VectorXcd& start, Goals goals, const GoalPath& path,
                                     double sense) const {
    for (std::size_t h = 0; h < goals.holds.size(); ++h) {
        const Hold& hold = problem_->binding().holds[h];
        if (hold.turn.empty() || goals.holds[h].angle_rad) continue;
        double turn = path.turn_rad(h);
        if (std::abs(turn) > std::numbers::pi / 2) {
            if (sense * turn < 0) turn += sense * 2 * std::numbers::pi;
        } else if (path.squeeze(h) <= squeezed) {
            turn = sense * turned_over_rad;
        }
        goals.holds[h].way_rad = std::arg(row_value(hold.turn, start)) + turn;
    }
    return goals;
}

// Other ways where they differ, and the best end.
VariationalDeformer::Outcome VariationalDeformer::best_lead(const Eigen::VectorXcd& start, const Goals& goals,
                                                            bool warm, Progress& progress) const {
    const int most = problem_->options().max_iterations;
    const bool guided = says_turns(goals);
    Outcome first = lead(start, goals, guided ? Way::following : Way::turning, most, progress);
    // Where a pose was saved in a minimum, its turns tell that from others.
    if (guided ? first.minimum.converged && first.turn_error < same_turn_rad : warm || !first.minimum.converged) {
        return first;
    }
    if (guided) {
        // What followed of itself may have spent all on folds that cost no end of iterations.
        Outcome second = lead(start, goals, Way::turning, most, progress);
        const bool told_apart = std::abs(second.turn_error - first.turn_error) > same_turn_rad;
        if (told_apart ? second.turn_error < first.turn_error : second.value < better_share * first.value) {
            first = std::move(second);
        }
    } else {
        const Goals from = goals_at(start, problem_->binding(), goals);
        const GoalPath path(problem_->binding(), from, goals, problem_->size(), Way::turning);
        if (path.widest_turn_rad() < far_turn_rad && path.strongest_squeeze() > squeezed) return first;
        // What came out well at a moderate turn is the natural end.
        if (path.widest_turn_rad() < very_far_turn_rad && problem_->looks_natural(first.x)) return first;
        const auto try_way = [&](const Goals& by, Way way) {
            Outcome other = lead(start, by, way, most, progress);
            if (other.value < better_share * first.value) first = std::move(other);
        };
        for (const double sense : {1.0, -1.0}) {
            const Goals turned = turned_by(start, goals, path, sense);
            try_way(turned, Way::turning);
            try_way(turned, Way::following);
        }
        try_way(goals, Way::straight);
    }
    return first;
}

// A fixed angle leaves the turn a line through 0: a disc that was crushed there may have come out on the other side,
// turned by 180 degrees too many. Such goals get the scale of the rest pose.
// \return whether there was one.
bool VariationalDeformer::keep_facing(const Eigen::VectorXcd& x, Goals& goals) const {
    bool changed = false;
    for (std::size_t h = 0; h < goals.holds.size(); ++h) {
        HoldGoal& goal = goals.holds[h];
        if (!goal.angle_rad || goal.scale) continue;
        const Complex turn = row_value(problem_->binding().holds[h].turn, x);
        if ((turn * std::polar(1.0, -*goal.angle_rad)).real() > crushed) continue;
        goal.scale = 1;
        changed = true;
    }
    return changed;
}

Deformation VariationalDeformer::deform(const Pose& pose, const Eigen::MatrixX2d* start, Progress& progress) const {
    Goals goals = problem_->goals(pose);
    const Eigen::VectorXcd& rest = problem_->rest();
    if (start != nullptr && (start->rows() != rest.size() || !start->allFinite())) {
        throw InvalidInput("start", "it is not one finite position for each vertex of the mesh");
    }
    if (start != nullptr) {
        for (HoldGoal& goal : goals.holds) goal.way_rad.reset();  // it has turned already
    }
    const double size = problem_->size();
    Eigen::VectorXcd x = start != nullptr ? complex_positions(*start) : rigid_fit(rest, problem_->binding(), goals);
    for (Eigen::Index v = 0; v < x.size(); ++v) {
        if (problem_->binding().loose[static_cast<std::size_t>(v)]) x(v) = rest(v);
    }
    Deformation result;
    result.warnings = problem_->binding().warnings;
    const Objective objective = problem_->objective(goals, x);
    if (!(objective.value(x) < std::numeric_limits<double>::infinity())) {
        throw InvalidInput("start", "it has triangles that are folded over", "start from the rest pose");
    }
    Eigen::VectorXcd placed = x;
    problem_->place_held(goals, placed);
    const double energy = objective.value(placed);
    const bool settled = !are_wound(goals, placed, problem_->binding()) && energy <= round_off_energy * size * size &&
                         largest_error(placed, problem_->binding(), goals) <= round_off_share * size;
    if (settled || !problem_->has_unknowns()) {
        x = placed;  // a rigid motion, or nothing is free: nothing is left to solve
        result.energy_history = {energy};
    } else {
        Outcome outcome = best_lead(x, goals, start != nullptr, progress);
        result.iterations = outcome.minimum.iterations;
        if (keep_facing(outcome.x, goals)) {
            outcome = best_lead(x, goals, start != nullptr, progress);
            result.iterations = outcome.minimum.iterations;
        }
        result.converged = outcome.minimum.converged;
        result.energy_history = std::move(outcome.minimum.history);
        x = std::move(outcome.x);
    }
    result.energy = result.energy_history.back();
    result.V = point_positions(x);
    result.max_handle_error_px = largest_error(x, problem_->binding(), goals);
    if (!problem_->guards_folds() && result.max_handle_error_px > contradiction * size) {
        throw InvalidInput("pose '" + pose.name + "'",
                           "handles that are close together ask for what cannot be met together",
                           "move them apart, or remove one");
    }
    return result;
}

}  // namespace puppetwarp
