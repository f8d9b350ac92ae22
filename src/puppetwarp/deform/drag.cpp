#include <puppetwarp/deform/drag.h>

#include <puppetwarp/deform/variational.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace puppetwarp {

namespace {

using Complex = std::complex<double>;

// Moves below this share of the subject's size cannot be seen.
constexpr double settled_share = 5e-5;
// On the way to far targets, near is enough.
constexpr double on_the_way_share = 2e-3;
// Without a worker: iterations beyond the first of each call that pay for a factor.
constexpr int worth_a_factor = 14;
// The widest turn in one stride: a pose that follows another is near as a rule.
constexpr double stride_rad = 0.5;
// Energies below this share of the squared size are what round-off makes of none.
constexpr double round_off_energy = 1e-18;

double unwrapped(double angle, double last) {
    return last + std::remainder(angle - last, 2 * std::numbers::pi);
}

// A drag has its own way: what a pose remembers of another is not gone again.
Goals without_ways(Goals goals) {
    for (HoldGoal& goal : goals.holds) goal.way_rad.reset();
    return goals;
}

}  // namespace

Drag::Drag(std::shared_ptr<const VariationalProblem> problem, bool worker) : problem_(std::move(problem)) {
    turns_.resize(problem_->binding().holds.size());
    state_ = state_at(*problem_, problem_->rest());
    if (problem_->has_unknowns()) metric_ = problem_->metric(state_->descent.x(), state_->objective);
    if (worker && !problem_->constant_metric()) worker_ = std::make_unique<MetricWorker>();
}

std::unique_ptr<Drag::State> Drag::state_at(const VariationalProblem& problem, Eigen::VectorXcd x) {
    const Goals goals = without_ways(problem.goals(Pose{}));
    Objective objective = problem.objective(goals_at(x, problem.binding(), goals), x);
    return std::make_unique<State>(std::move(objective), std::move(x));
}

// Of a new hold: what lies beside one that went round and round has gone round as often.
double Drag::turn_beside(const Hold& hold) const {
    const std::vector<Hold>& known = problem_->binding().holds;
    double nearest = std::numeric_limits<double>::infinity();
    double turn_there = 0;
    for (std::size_t h = 0; h < known.size(); ++h) {
        if (known[h].turn.empty() || known[h].component != hold.component) continue;
        const double distance = std::abs(known[h].at - hold.at);
        if (distance >= nearest) continue;
        nearest = distance;
        turn_there = turns_[h];
    }
    return unwrapped(hold.turn.empty() ? 0 : std::arg(row_value(hold.turn, state_->descent.x())), turn_there);
}

void Drag::set_problem(std::shared_ptr<const VariationalProblem> problem) {
    if (worker_) worker_->drop();
    std::vector<double> turns;
    for (const Hold& hold : problem->binding().holds) turns.push_back(turn_beside(hold));
    std::unique_ptr<State> state = state_at(*problem, state_->descent.x());
    std::shared_ptr<ConstrainedMetric> metric;
    if (problem->has_unknowns()) {
        metric = metric_ && problem->shares_factors_with(*problem_)
                     ? problem->adopted(*metric_, *problem_, state->objective)
                     : problem->metric(state->descent.x(), state->objective);
    }
    // Nothing can fail from here on: until here everything is as it was.
    state_ = std::move(state);
    problem_ = std::move(problem);
    turns_ = std::move(turns);
    metric_ = std::move(metric);
    last_goals_.reset();
}

// Aims at the goals, or at as much of the way to them as can be followed.
// \return whether that was all of it.
bool Drag::stride_towards(const Goals& goals) {
    Eigen::VectorXcd x = state_->descent.x();
    const GoalPath path(problem_->binding(), goals_at(x, problem_->binding(), goals), goals, problem_->size(),
                        Way::straight);
    const int strides = path.strides(stride_rad);
    const Goals here = path.at(1.0 / strides);
    problem_->place_held(here, x);
    problem_->aim(state_->objective, here, x);
    state_->descent.restart_at(std::move(x));
    if (metric_) {
        if (problem_->choose(*metric_, state_->objective)) state_->descent.forget();
        state_->descent.meet_conditions(*metric_);
    }
    converged_ = false;
    gained_ = state_->descent.value();
    return strides == 1;
}

void Drag::take_new_metric() {
    if (!worker_) return;
    std::shared_ptr<ConstrainedMetric> fresh = worker_->take();
    if (!fresh) return;
    metric_ = std::move(fresh);
    problem_->choose(*metric_, state_->objective);
    state_->descent.forget();
    age_ = 0;
}

// \param urgent  the metric at hand leads nowhere.
void Drag::ask_for_metric(bool urgent) {
    if (problem_->constant_metric() && !urgent) return;
    const auto make = [problem = problem_, x = state_->descent.x(), objective = state_->objective] {
        return problem->exact_metric(x, objective);
    };
    if (worker_) {
        worker_->start(make);
        return;
    }
    if (!urgent && age_ < worth_a_factor) return;
    metric_ = make();
    state_->descent.forget();
    age_ = 0;
}

// One iteration.
Drag::Went Drag::iterate(bool to_the_end, InteractiveFrame& frame) {
    Descent& descent = state_->descent;
    const double left = descent.choose_direction(*metric_);
    const double reach = descent.reach();
    const double floor = round_off_energy * problem_->size() * problem_->size();
    const double enough = problem_->options().tolerance * std::max(descent.value(), floor);
    converged_ = left <= (metric_->exact() ? 0.1 : 1e-3) * enough && gained_ <= enough;
    if (converged_ || (!to_the_end && reach <= settled_share * problem_->size())) return Went::settled;
    const double before = descent.value();
    const double length = descent.step();
    if (length == 0) {
        if (descent.remembers()) {
            descent.forget();
            return Went::on;
        }
        // Not even the plain step gains anything: round-off, unless the metric is to blame.
        converged_ = metric_->exact() && left <= 1e-3 * std::max(descent.value(), floor);
        return Went::nowhere;
    }
    gained_ = before - descent.value();
    ++frame.iterations;
    if (++served_ > 1) ++age_;
    return Went::on;
}

void Drag::follow_turns() {
    const std::vector<Hold>& holds = problem_->binding().holds;
    for (std::size_t h = 0; h < holds.size(); ++h) {
        if (holds[h].turn.empty()) continue;
        turns_[h] = unwrapped(std::arg(row_value(holds[h].turn, state_->descent.x())), turns_[h]);
    }
}

InteractiveFrame Drag::advance(const Pose& pose, double budget_ms) {
    const auto end = Clock::now() + std::chrono::duration<double, std::milli>(budget_ms);
    const Goals goals = without_ways(problem_->goals(pose));
    // Calls with one pose go on to the end; the first of them settles.
    const bool again = last_goals_ && *last_goals_ == goals;
    last_goals_ = goals;
    if (!again) served_ = 0;
    take_new_metric();
    InteractiveFrame frame;
    bool there = again && at_goals_;
    if (!there) there = stride_towards(goals);
    while (metric_ && !converged_) {
        const Went went = iterate(again && there, frame);
        if (went == Went::nowhere) ask_for_metric(true);
        follow_turns();
        const bool near = went != Went::on || state_->descent.reach() <= on_the_way_share * problem_->size();
        if (there && went != Went::on) break;
        if (!there && near) there = stride_towards(goals);
        if (Clock::now() >= end) break;
    }
    at_goals_ = there;
    if (frame.iterations > 0) ask_for_metric(false);
    frame.V = point_positions(state_->descent.x());
    frame.converged = there && (converged_ || !metric_);
    frame.settled = there && (frame.converged || state_->descent.reach() <= settled_share * problem_->size());
    frame.energy = state_->descent.value();
    frame.max_handle_error_px = largest_error(state_->descent.x(), problem_->binding(), goals);
    return frame;
}

InteractiveFrame Drag::restart(const Pose& pose, Progress& progress) {
    const VariationalDeformer deformer(problem_);
    const Deformation deformation = deformer.deform(pose, nullptr, progress);
    const Goals goals = problem_->goals(pose);
    if (worker_) worker_->drop();
    state_ = state_at(*problem_, complex_positions(deformation.V));
    const std::vector<Hold>& holds = problem_->binding().holds;
    for (std::size_t h = 0; h < holds.size(); ++h) {
        if (holds[h].turn.empty()) continue;
        const HoldGoal& goal = goals.holds[h];
        turns_[h] = unwrapped(std::arg(row_value(holds[h].turn, state_->descent.x())),
                              goal.angle_rad.value_or(goal.way_rad.value_or(0)));
    }
    stride_towards(without_ways(goals));
    if (problem_->has_unknowns()) metric_ = problem_->metric(state_->descent.x(), state_->objective);
    at_goals_ = true;
    last_goals_ = without_ways(goals);
    InteractiveFrame frame;
    frame.V = deformation.V;
    frame.converged = frame.settled = deformation.converged;
    frame.iterations = deformation.iterations;
    frame.energy = deformation.energy;
    frame.max_handle_error_px = deformation.max_handle_error_px;
    return frame;
}

}  // namespace puppetwarp
