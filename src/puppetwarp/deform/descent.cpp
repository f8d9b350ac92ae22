#include <puppetwarp/deform/descent.h>

#include <cmath>
#include <utility>

namespace puppetwarp {

namespace {

constexpr std::size_t memory = 8;
constexpr double armijo = 1e-4;
constexpr int most_halvings = 40;
// How near to the end of the energy's domain a step may go.
constexpr double domain_share = 0.9;
// Steps that leave more than this share of what there was to gain four steps before are worth a new factor.
constexpr double slow_progress = 0.03;

double dot(const Eigen::VectorXcd& a, const Eigen::VectorXcd& b) {
    double sum = 0;
    for (Eigen::Index v = 0; v < a.size(); ++v) sum += a(v).real() * b(v).real() + a(v).imag() * b(v).imag();
    return sum;
}

// When the factor has been outrun.
class RenewalRule {
public:
    void restart() { *this = {}; }
    //! \param left  what was left to gain before this step.
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

Descent::Descent(const Objective& objective, Eigen::VectorXcd x) : objective_(objective), x_(std::move(x)) {}

double Descent::value() const {
    evaluate();
    return value_;
}

void Descent::evaluate() const {
    if (evaluated_) return;
    value_ = objective_.gradient(x_, gradient_);
    evaluated_ = true;
}

void Descent::restart() {
    evaluated_ = false;
}

void Descent::restart_at(Eigen::VectorXcd x) {
    x_ = std::move(x);
    restart();
}

void Descent::meet_conditions(const ConstrainedMetric& metric) {
    if (objective_.penalty > 0 || objective_.conditions.empty()) return;
    const Eigen::VectorXd missing = objective_.missing(x_);
    const Eigen::VectorXcd start = x_;
    const double before = value();
    x_ -= metric.step(gradient_, -missing);
    polish_conditions(metric);
    if (value() <= before) return;
    // Far from a minimum the Newton step may lead anywhere, stride for stride farther: its model ends long before.
    Eigen::VectorXcd cheapest = start + metric.correction(missing);
    if (value() <= objective_.value(cheapest)) return;
    x_ = std::move(cheapest);
    polish_conditions(metric);
}

void Descent::polish_conditions(const ConstrainedMetric& metric) {
    if (objective_.penalty > 0 || objective_.conditions.empty()) return;
    for (int pass = 0; pass < 2; ++pass) x_ += metric.correction(objective_.missing(x_));
    restart();
}

Eigen::VectorXcd Descent::preconditioned(Eigen::VectorXcd q, const ConstrainedMetric& metric) const {
    std::vector<double> alpha(pairs_.size());
    for (std::size_t k = pairs_.size(); k-- > 0;) {
        alpha[k] = dot(pairs_[k].step, q) / pairs_[k].product;
        q -= alpha[k] * pairs_[k].change;
    }
    q = metric.step(q);
    for (std::size_t k = 0; k < pairs_.size(); ++k) {
        q += (alpha[k] - dot(pairs_[k].change, q) / pairs_[k].product) * pairs_[k].step;
    }
    return q;
}

double Descent::choose_direction(const ConstrainedMetric& metric) {
    evaluate();
    direction_ = -preconditioned(gradient_, metric);
    slope_ = dot(gradient_, direction_);
    if (slope_ >= 0 && remembers()) {
        forget();  // the memory no longer fits
        direction_ = -metric.step(gradient_);
        slope_ = dot(gradient_, direction_);
    }
    return std::max(0.0, -slope_ / 2);
}

double Descent::step() {
    if (!(slope_ < 0)) return 0;
    double length = std::min(1.0, domain_share * objective_.energy.largest_step(x_, direction_));
    for (int halving = 0; halving < most_halvings; ++halving, length /= 2) {
        Eigen::VectorXcd y = x_ + length * direction_;
        Eigen::VectorXcd gradient;
        const double value = objective_.gradient(y, gradient);
        if (!(value <= value_ + armijo * length * slope_) || !(value < value_)) continue;
        Pair pair{y - x_, gradient - gradient_, 0};
        pair.product = dot(pair.step, pair.change);
        if (pair.product > 1e-12 * pair.step.norm() * pair.change.norm()) {
            pairs_.push_back(std::move(pair));
            if (pairs_.size() > memory) pairs_.pop_front();
        }
        x_ = std::move(y);
        gradient_ = std::move(gradient);
        value_ = value;
        evaluated_ = true;
        return length;
    }
    return 0;
}

Minimum minimise(Descent& descent, std::shared_ptr<ConstrainedMetric>& metric, const MetricMaker& renewed,
                 const StopRule& rule, Progress& progress) {
    RenewalRule renewal;
    Minimum result;
    result.history.push_back(descent.value());
    double gained = descent.value();
    bool fresh = false;  // the metric is of this x
    const auto renew = [&](bool stuck) {
        renewal.restart();
        fresh = stuck;
        std::shared_ptr<ConstrainedMetric> newer = renewed(descent.x(), result.iterations, stuck);
        if (!newer) return;
        metric = std::move(newer);
        descent.forget();
        fresh = true;
    };
    while (true) {
        const double left = descent.choose_direction(*metric);
        const double enough = rule.tolerance * std::max(descent.value(), rule.floor);
        // A metric that is stiffer than the energy makes what is left look small.
        const double trust = metric->exact() ? 0.1 : 1e-3;
        result.converged = left <= trust * enough && (gained <= enough || result.iterations == 0);
        if (result.converged || result.iterations >= rule.max_iterations) break;
        progress.step("deform", static_cast<double>(result.iterations) / rule.max_iterations);

        const double before = descent.value();
        const double length = descent.step();
        if (length == 0) {
            if (descent.remembers()) {
                descent.forget();
            } else if (!fresh) {
                renew(true);
            } else {
                // Not even the Newton step gains anything: what is left is round-off.
                result.converged = left <= 1e-3 * std::max(descent.value(), rule.floor);
                break;
            }
            continue;
        }
        fresh = false;
        gained = before - descent.value();
        ++result.iterations;
        result.history.push_back(descent.value());
        if (renewal.due(length, left)) renew(false);
    }
    return result;
}

}  // namespace puppetwarp
