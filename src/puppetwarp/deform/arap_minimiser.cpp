#include <puppetwarp/deform/arap_minimiser.h>

#include <cmath>
#include <deque>
#include <utility>

namespace puppetwarp {

namespace {

constexpr std::size_t memory = 8;
constexpr double armijo = 1e-4;
constexpr int shortest_halving = 40;
// Four steps that leave more than this share of what there was to gain are worth a new factor.
constexpr double slow_progress = 0.03;

// The last steps with the changes of gradient they made, and the two-loop product with them.
class StepMemory {
public:
    void clear() { pairs_.clear(); }
    bool empty() const { return pairs_.empty(); }

    void remember(Eigen::VectorXd step, Eigen::VectorXd change) {
        const double product = step.dot(change);
        if (!(product > 1e-12 * step.norm() * change.norm())) return;
        pairs_.push_back({std::move(step), std::move(change), product});
        if (pairs_.size() > memory) pairs_.pop_front();
    }

    template <typename Metric>
    Eigen::VectorXd times(Eigen::VectorXd q, const Metric& metric) const {
        std::vector<double> alpha(pairs_.size());
        for (std::size_t k = pairs_.size(); k-- > 0;) {
            alpha[k] = pairs_[k].step.dot(q) / pairs_[k].product;
            q -= alpha[k] * pairs_[k].change;
        }
        metric(q);
        for (std::size_t k = 0; k < pairs_.size(); ++k) {
            q += (alpha[k] - pairs_[k].change.dot(q) / pairs_[k].product) * pairs_[k].step;
        }
        return q;
    }

private:
    struct Pair {
        Eigen::VectorXd step;
        Eigen::VectorXd change;
        double product;
    };
    std::deque<Pair> pairs_;
};

// One run of the minimiser: what changes from iteration to iteration.
class Descent {
public:
    Descent(const ArapSystem& system, const ArapCells& cells, const ConstraintSpace& constraints,
            ArapSystem::Factor& factor, Eigen::VectorXcd& x)
        : system_(system), cells_(cells), constraints_(constraints), factor_(factor), x_(x) {
        energy_ = cells_.gradient(x_, full_gradient_);
        gradient_ = projected_gradient();
    }

    double energy() const { return energy_; }
    ArapSystem::Hessian hessian() const { return factor_.kind; }

    //! Chooses a direction of descent. \return about what is left to gain.
    double choose_direction() {
        const auto metric = [&](Eigen::VectorXd& q) {
            constraints_.project(q);
            factor_.cholesky.solve_in_place(q);
            constraints_.project(q);
        };
        direction_ = -steps_.times(gradient_, metric);
        slope_ = gradient_.dot(direction_);
        if (slope_ >= 0) {
            // Round-off, or a memory that no longer fits.
            steps_.clear();
            direction_ = -gradient_;
            metric(direction_);
            slope_ = gradient_.dot(direction_);
        }
        return -slope_ / 2;
    }

    //! \return the length of the step taken, or 0 when no step lowers the energy.
    double step() {
        double length = 1;
        for (int halving = 0; halving < shortest_halving; ++halving, length /= 2) {
            Eigen::VectorXcd y = x_;
            system_.add(length, direction_, y);
            Eigen::VectorXcd full;
            const double energy = cells_.gradient(y, full);
            if (!(energy <= energy_ + armijo * length * slope_) || !(energy < energy_)) continue;
            x_ = std::move(y);
            full_gradient_ = std::move(full);
            energy_ = energy;
            Eigen::VectorXd fresh = projected_gradient();
            steps_.remember(length * direction_, fresh - gradient_);
            gradient_ = std::move(fresh);
            return length;
        }
        return 0;
    }

    void renew_factor(bool try_exact) {
        factor_ = system_.factorise(x_, constraints_, try_exact);
        steps_.clear();
    }
    void forget() { steps_.clear(); }
    bool remembers() const { return !steps_.empty(); }

private:
    Eigen::VectorXd projected_gradient() const {
        Eigen::VectorXd g = system_.restricted(full_gradient_);
        constraints_.project(g);
        return g;
    }

    const ArapSystem& system_;
    const ArapCells& cells_;
    const ConstraintSpace& constraints_;
    ArapSystem::Factor& factor_;
    Eigen::VectorXcd& x_;
    Eigen::VectorXcd full_gradient_;
    Eigen::VectorXd gradient_;
    Eigen::VectorXd direction_;
    StepMemory steps_;
    double energy_ = 0;
    double slope_ = 0;
};

// When the factor has been outrun.
class RenewalRule {
public:
    void restart() { *this = {}; }
    //! \param left  what is left to gain before this step.
    bool due(double length, double left) {
        short_steps_ = length <= 0.25 ? short_steps_ + 1 : 0;
        ++age_;
        if (age_ % 4 == 0) {
            slow_ = left > slow_progress * left_before_;
            left_before_ = left;
        } else if (age_ == 1) {
            left_before_ = left;
        }
        return short_steps_ >= 3 || slow_;
    }

private:
    int age_ = 0;
    int short_steps_ = 0;
    double left_before_ = 0;
    bool slow_ = false;
};

}  // namespace

void step_onto(const ArapSystem& system, const ArapCells& cells, const ConstraintSpace& constraints,
               const ArapSystem::Factor& factor, const Eigen::VectorXd& d, Eigen::VectorXcd& x) {
    if (constraints.C().rows() == 0) return;
    Eigen::VectorXcd gradient;
    cells.gradient(x, gradient);
    const Eigen::VectorXd missing = d - constraints.C() * system.restricted(x);
    Eigen::VectorXd step = system.penalty() * (constraints.C().transpose() * missing) - system.restricted(gradient);
    factor.cholesky.solve_in_place(step);
    system.add(1, step, x);
    system.add(1, constraints.step_onto(system.restricted(x), d), x);
}

ArapMinimum minimise(const ArapSystem& system, const ArapCells& cells, const ConstraintSpace& constraints,
                     const ArapStop& stop, ArapSystem::Factor& factor, Eigen::VectorXcd& x, Progress& progress) {
    Descent descent(system, cells, constraints, factor, x);
    RenewalRule renewal;
    ArapMinimum result;
    result.energy_history.push_back(descent.energy());
    double gained = descent.energy();
    bool fresh = false;  // the factor is of this x
    while (true) {
        const double left = descent.choose_direction();
        const double enough = stop.tolerance * std::max(descent.energy(), stop.energy_floor);
        // A metric that is stiffer than the energy makes what is left look small.
        const double trust = descent.hessian() == ArapSystem::Hessian::exact ? 0.1 : 1e-3;
        result.converged = left <= trust * enough && (gained <= enough || result.iterations == 0);
        if (result.converged || result.iterations >= stop.max_iterations) break;
        progress.step("deform", static_cast<double>(result.iterations) / stop.max_iterations);

        const double before = descent.energy();
        const double length = descent.step();
        if (length == 0) {
            if (descent.remembers()) {
                descent.forget();
            } else if (!fresh) {
                descent.renew_factor(true);
                fresh = true;
            } else {
                // Not even the Newton step gains anything: what is left is round-off.
                result.converged = left <= 1e-3 * std::max(descent.energy(), stop.energy_floor);
                break;
            }
            continue;
        }
        fresh = false;
        gained = before - descent.energy();
        ++result.iterations;
        result.energy_history.push_back(descent.energy());
        if (renewal.due(length, left)) {
            descent.renew_factor(true);
            renewal.restart();
            fresh = true;
        }
    }
    return result;
}

}  // namespace puppetwarp
