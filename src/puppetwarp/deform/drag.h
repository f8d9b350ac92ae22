#pragma once
// Private header.

#include <puppetwarp/deform/interactive_solver.h>
#include <puppetwarp/deform/metric_worker.h>
#include <puppetwarp/deform/variational_problem.h>

#include <chrono>

namespace puppetwarp {

//! The state of a variational method that follows its handles: InteractiveSolver's working part.
class Drag {
public:
    //! \param worker  whether metrics are made by a thread of their own.
    Drag(std::shared_ptr<const VariationalProblem> problem, bool worker);

    const VariationalProblem& problem() const { return *problem_; }
    //! Goes on with another rig on the same mesh.
    void set_problem(std::shared_ptr<const VariationalProblem> problem);

    InteractiveFrame advance(const Pose& pose, double budget_ms);
    InteractiveFrame restart(const Pose& pose, Progress& progress);
    //! Of a hold, unwrapped.
    double turn_rad(std::size_t hold) const { return turns_[hold]; }

private:
    using Clock = std::chrono::steady_clock;

    // Everything that is for one problem and its conditions at a time; replaced as a whole.
    struct State {
        Objective objective;
        Descent descent;
        State(Objective o, Eigen::VectorXcd x) : objective(std::move(o)), descent(objective, std::move(x)) {}
        State(const State&) = delete;
    };

    static std::unique_ptr<State> state_at(const VariationalProblem& problem, Eigen::VectorXcd x);
    double turn_beside(const Hold& hold) const;
    bool stride_towards(const Goals& goals);
    enum class Went { on, settled, nowhere };
    Went iterate(bool to_the_end, InteractiveFrame& frame);
    void take_new_metric();
    void ask_for_metric(bool urgent);
    void follow_turns();

    std::shared_ptr<const VariationalProblem> problem_;
    std::unique_ptr<MetricWorker> worker_;
    std::unique_ptr<State> state_;
    std::shared_ptr<ConstrainedMetric> metric_;
    std::optional<Goals> last_goals_;
    std::vector<double> turns_;  // of each hold
    int served_ = 0;             // iterations for the goals at hand
    int age_ = 0;                // iterations that the metric has served beyond the first for each goals
    bool converged_ = false;
    bool at_goals_ = false;
    double gained_ = 0;
};

}  // namespace puppetwarp
