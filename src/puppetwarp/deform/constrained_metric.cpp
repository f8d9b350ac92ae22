#include <puppetwarp/deform/constrained_metric.h>

#include <algorithm>
#include <cassert>
#include <tuple>
#include <utility>

namespace puppetwarp {

namespace {

using Complex = std::complex<double>;

// Makes the system regular where conditions repeat each other; one refinement takes it out again.
constexpr double compliance = 1e-12;

ComplexRow turned(const ComplexRow& row, const Complex& direction) {
    ComplexRow result = row;
    for (auto& entry : result) entry.second *= std::conj(direction);
    return result;
}

}  // namespace

double left_side(const Condition& condition, const std::vector<ComplexRow>& rows, const Eigen::VectorXcd& x) {
    return (std::conj(condition.direction) * row_value(rows[static_cast<std::size_t>(condition.row)], x)).real();
}

ConstrainedMetric::ConstrainedMetric(std::shared_ptr<const FactoredHessian> hessian, Eigen::Index vertices,
                                     const VertexSprings& grounds, double penalty)
    : hessian_(std::move(hessian)), vertices_(vertices), penalty_(penalty), ground_stiffness_(grounds.stiffness) {
    for (const int v : grounds.vertices) ground_rows_.push_back({{v, 1.0}});
}

std::shared_ptr<ConstrainedMetric> ConstrainedMetric::with_rows(const std::vector<int>& old_of_new) const {
    auto metric = std::make_shared<ConstrainedMetric>(hessian_, vertices_, VertexSprings{}, penalty_);
    metric->ground_stiffness_ = ground_stiffness_;
    metric->ground_rows_ = ground_rows_;
    for (const auto& [key, response] : responses_) {
        if (key < 0) metric->responses_.emplace(key, response);
    }
    for (std::size_t row = 0; row < old_of_new.size(); ++row) {
        const auto found = old_of_new[row] < 0 ? responses_.end() : responses_.find(old_of_new[row]);
        if (found != responses_.end()) metric->responses_.emplace(static_cast<int>(row), found->second);
    }
    return metric;
}

ConstrainedMetric::SharedResponse ConstrainedMetric::response(int key, const ComplexRow& row) {
    const auto found = responses_.find(key);
    if (found != responses_.end()) return found->second;
    Eigen::VectorXcd load = Eigen::VectorXcd::Zero(vertices_);
    for (const auto& [vertex, c] : row) load(vertex) += std::conj(c);
    auto response = std::make_shared<Response>();
    std::tie(response->re, response->im) = hessian_->inverse_times_both(load);
    return responses_.emplace(key, std::move(response)).first->second;
}

double ConstrainedMetric::Functional::of(const Eigen::VectorXcd& x) const {
    double sum = 0;
    for (const auto& [vertex, c] : row) sum += c.real() * x(vertex).real() - c.imag() * x(vertex).imag();
    return sum;
}

// The values of conditions are no part of the system.
bool ConstrainedMetric::same_as_chosen(const std::vector<Condition>& conditions, bool keep_grounds) const {
    return chosen_ && grounds_kept_ == keep_grounds &&
           std::equal(
               chosen_->begin(), chosen_->end(), conditions.begin(), conditions.end(),
               [](const Condition& a, const Condition& b) { return a.row == b.row && a.direction == b.direction; });
}

void ConstrainedMetric::choose(const std::vector<ComplexRow>& rows, const std::vector<Condition>& conditions,
                               bool keep_grounds) {
    if (same_as_chosen(conditions, keep_grounds)) return;
    chosen_ = conditions;
    grounds_kept_ = keep_grounds;
    const std::size_t grounds = keep_grounds ? 0 : 2 * ground_rows_.size();
    const auto count = static_cast<Eigen::Index>(conditions.size());
    const auto all = count + static_cast<Eigen::Index>(grounds);
    functionals_.clear();
    if (all == 0) return;
    const auto add = [&](int key, const ComplexRow& row, const Complex& direction) {
        functionals_.push_back({turned(row, direction), direction, response(key, row)});
    };
    for (const Condition& condition : conditions) {
        add(condition.row, rows[static_cast<std::size_t>(condition.row)], condition.direction);
    }
    for (std::size_t g = 0; g < grounds; ++g) {
        add(-1 - static_cast<int>(g / 2), ground_rows_[g / 2], g % 2 == 0 ? Complex(1) : Complex(0, 1));
    }
    Eigen::MatrixXd system(all, all);
    for (Eigen::Index j = 0; j < all; ++j) {
        const Functional& column = functionals_[static_cast<std::size_t>(j)];
        for (Eigen::Index i = 0; i < all; ++i) {
            const Functional& row = functionals_[static_cast<std::size_t>(i)];
            system(i, j) = column.direction.real() * row.of(column.response->re) +
                           column.direction.imag() * row.of(column.response->im);
        }
    }
    for (Eigen::Index i = 0; i < count && penalty_ > 0; ++i) system(i, i) += 1 / penalty_;
    for (Eigen::Index i = count; i < all; ++i) system(i, i) -= 1 / ground_stiffness_;
    system_ = system;
    for (Eigen::Index i = 0; i < count && penalty_ == 0; ++i) system(i, i) *= 1 + compliance;
    factor_.compute(system);
}

Eigen::VectorXcd ConstrainedMetric::step(const Eigen::VectorXcd& q, const Eigen::VectorXd& missing) const {
    Eigen::VectorXcd p = hessian_->inverse_times(q);
    bring_onto(missing, p);
    return p;
}

Eigen::VectorXcd ConstrainedMetric::correction(const Eigen::VectorXd& missing) const {
    Eigen::VectorXcd p = Eigen::VectorXcd::Zero(vertices_);
    bring_onto(missing, p);
    return p;
}

void ConstrainedMetric::bring_onto(const Eigen::VectorXd& missing, Eigen::VectorXcd& p) const {
    assert(missing.size() == 0 || penalty_ == 0);
    if (functionals_.empty()) return;
    Eigen::VectorXd off(static_cast<Eigen::Index>(functionals_.size()));
    for (Eigen::Index i = 0; i < off.size(); ++i) off(i) = functionals_[static_cast<std::size_t>(i)].of(p);
    off.head(missing.size()) -= missing;
    Eigen::VectorXd forces = factor_.solve(off);
    // Without this the compliance would let the conditions drift, a little in each step, along the forces on them.
    forces += factor_.solve(off - system_ * forces);
    for (Eigen::Index i = 0; i < off.size(); ++i) {
        const Functional& functional = functionals_[static_cast<std::size_t>(i)];
        const Complex force = forces(i) * functional.direction;
        if (force.real() != 0) p -= force.real() * functional.response->re;
        if (force.imag() != 0) p -= force.imag() * functional.response->im;
    }
}

}  // namespace puppetwarp
