#pragma once
// Private header.

#include <puppetwarp/base/progress.h>
#include <puppetwarp/deform/objective.h>

#include <deque>
#include <functional>
#include <memory>
#include <vector>

namespace puppetwarp {

//! L-BFGS over eight steps, its metric a factored Hessian of somewhere near, with Armijo's rule and steps bounded by
//! where the energy stops to be defined.   ALGORITHMS.md section 4; Nocedal & Wright 2006, algorithm 7.4.
class Descent {
public:
    //! \param objective  kept by reference: its conditions may change between steps, see `restart`.
    //! \param x          #V; the energy is defined there.
    Descent(const Objective& objective, Eigen::VectorXcd x);

    const Eigen::VectorXcd& x() const { return x_; }
    double value() const;

    //! To be called when the objective has changed: value and gradient are others. What was learned stays.
    void restart();
    //! Moves to other positions, where vertices that may not move were put elsewhere. What was learned stays.
    void restart_at(Eigen::VectorXcd x);
    //! Meets exact conditions, however far that is: by one Newton step, or by the cheapest move in the metric where
    //! that costs less.
    void meet_conditions(const ConstrainedMetric& metric);
    //! Takes away what round-off left of exact conditions.
    void polish_conditions(const ConstrainedMetric& metric);
    //! Forgets the steps: their metric is gone.
    void forget() { pairs_.clear(); }
    bool remembers() const { return !pairs_.empty(); }

    //! \return about what is left to gain, at least 0; 0 when round-off hides the way down.
    double choose_direction(const ConstrainedMetric& metric);
    //! Longest move of a vertex in the chosen direction.
    double reach() const { return direction_.cwiseAbs().maxCoeff(); }
    //! Goes along the chosen direction.
    //! \return the share of it taken, or 0 when no share lowers the value.
    double step();

private:
    struct Pair {
        Eigen::VectorXcd step;
        Eigen::VectorXcd change;
        double product;
    };
    void evaluate() const;
    Eigen::VectorXcd preconditioned(Eigen::VectorXcd q, const ConstrainedMetric& metric) const;

    const Objective& objective_;
    Eigen::VectorXcd x_;
    // Found when first asked for: whoever sets positions and conditions one after the other pays once.
    mutable Eigen::VectorXcd gradient_;
    mutable double value_ = 0;
    mutable bool evaluated_ = false;
    Eigen::VectorXcd direction_;
    std::deque<Pair> pairs_;
    double slope_ = 0;
};

//! When to stop.
struct StopRule {
    double tolerance;  //!< relative: what is left to gain, and what the last step gained, against the value
    int max_iterations;
    double floor;  //!< values below are round-off, px^2
};

struct Minimum {
    int iterations = 0;
    bool converged = false;
    std::vector<double> history;  //!< values from the start on, never rising
};

//! Makes a metric for positions when the last one has been outrun, or null to go on with that.
//! `stuck`: the last one finds no way down at all.
using MetricMaker =
    std::function<std::shared_ptr<ConstrainedMetric>(const Eigen::VectorXcd& x, int iterations, bool stuck)>;

//! Descends until the rule says so. The metric is made anew when progress slows.
//! \param metric  in: one of somewhere near; out: the last one.
//! \throw Cancelled
Minimum minimise(Descent& descent, std::shared_ptr<ConstrainedMetric>& metric, const MetricMaker& renewed,
                 const StopRule& rule, Progress& progress);

}  // namespace puppetwarp
