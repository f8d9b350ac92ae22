#include <puppetwarp/deform/field_responses.h>

#include <algorithm>
#include <utility>

namespace puppetwarp {

namespace {

using Complex = std::complex<double>;

template <typename Values>
auto row_times(const std::vector<std::pair<int, double>>& row, const Values& x) {
    typename Values::Scalar sum = 0;
    for (const auto& [vertex, coefficient] : row) sum += coefficient * x(vertex);
    return sum;
}

}  // namespace

Complex FieldResponses::Response::turn(const Eigen::VectorXcd& u) const {
    return (row_times(rows[1], u) - Complex(0, 1) * row_times(rows[2], u)) / 2.0;
}

Complex FieldResponses::Response::shear(const Eigen::VectorXcd& u) const {
    return (row_times(rows[1], u) + Complex(0, 1) * row_times(rows[2], u)) / 2.0;
}

FieldResponses::Response FieldResponses::rows_of(const Hold& hold) {
    Response response;
    response.rows.resize(hold.turn.empty() ? 1 : 3);
    for (const auto& [vertex, weight] : hold.mean) response.rows[0].emplace_back(vertex, weight.real());
    if (hold.turn.empty()) return response;
    response.radius_px = hold.radius_px;
    // f_z = (d/dx - i d/dy) / 2.
    for (const auto& [vertex, coefficient] : hold.turn) {
        response.rows[1].emplace_back(vertex, 2 * hold.radius_px * coefficient.real());
        response.rows[2].emplace_back(vertex, -2 * hold.radius_px * coefficient.imag());
    }
    return response;
}

// Computes the fields that are missing, all in one go.
void FieldResponses::respond() {
    Eigen::Index missing = 0;
    for (const Response& response : responses_) {
        if (!response.fields) missing += static_cast<Eigen::Index>(response.rows.size());
    }
    Eigen::MatrixXd loads = Eigen::MatrixXd::Zero(inverse_->vertices(), missing);
    Eigen::Index column = 0;
    for (const Response& response : responses_) {
        if (response.fields) continue;
        for (const RealRow& row : response.rows) {
            for (const auto& [vertex, coefficient] : row) loads(vertex, column) += coefficient;
            ++column;
        }
    }
    if (missing > 0) loads = inverse_->respond(loads);
    column = 0;
    for (Response& response : responses_) {
        if (!response.fields) {
            const auto count = static_cast<Eigen::Index>(response.rows.size());
            response.fields = std::make_shared<const Eigen::MatrixXd>(loads.middleCols(column, count));
            column += count;
        }
        response.largest = response.fields->cwiseAbs().colwise().maxCoeff();
    }
}

FieldResponses::FieldResponses(std::shared_ptr<const FieldInverse> inverse, const Eigen::VectorXi& component,
                               const std::vector<bool>& held, const std::vector<Hold>& holds,
                               const FieldResponses* known)
    : inverse_(std::move(inverse)) {
    const auto n = static_cast<std::size_t>(component.size());
    // -2: nothing asks for the component's constant.
    std::vector<int> constant(n == 0 ? 0 : static_cast<std::size_t>(component.maxCoeff()) + 1, -2);
    const auto of = [&](std::size_t v) -> int& {
        return constant[static_cast<std::size_t>(component(static_cast<Eigen::Index>(v)))];
    };
    for (std::size_t v = 0; v < n; ++v) {
        if (held[v]) of(v) = -1;
    }
    for (const Hold& hold : holds) {
        int& number = constant[static_cast<std::size_t>(hold.component)];
        if (number == -2) number = constants_++;
        Response response = rows_of(hold);
        response.constant = number;
        if (response.rows.size() > 1) response.gradient = gradients_++;
        if (known != nullptr) {
            const auto same = std::find_if(known->responses_.begin(), known->responses_.end(),
                                           [&](const Response& other) { return other.rows == response.rows; });
            if (same != known->responses_.end()) response.fields = same->fields;
        }
        responses_.push_back(std::move(response));
    }
    constant_of_.resize(n);
    for (std::size_t v = 0; v < n; ++v) constant_of_[v] = std::max(of(v), -1);
    respond();
    system_.emplace(compliance());
}

ResponseSystem::Compliance FieldResponses::compliance() const {
    const auto m = static_cast<Eigen::Index>(responses_.size());
    const Eigen::Index g = 2 * gradients_;
    ResponseSystem::Compliance result{
        Eigen::MatrixXd(m, m), Eigen::MatrixXd(g, m), Eigen::MatrixXd(g, g), {}, constants_};
    for (Eigen::Index i = 0; i < m; ++i) {
        const Response& a = responses_[static_cast<std::size_t>(i)];
        result.constant_of.push_back(a.constant);
        for (Eigen::Index j = 0; j < m; ++j) {
            const Response& b = responses_[static_cast<std::size_t>(j)];
            result.means(i, j) = row_times(a.rows[0], b.fields->col(0));
            for (int p = 0; a.gradient >= 0 && p < 2; ++p) {
                const RealRow& row = a.rows[p == 0 ? 1 : 2];
                result.gradient_means(2 * a.gradient + p, j) = row_times(row, b.fields->col(0));
                for (int q = 0; b.gradient >= 0 && q < 2; ++q) {
                    result.gradients(2 * a.gradient + p, 2 * b.gradient + q) = row_times(row, b.fields->col(1 + q));
                }
            }
        }
    }
    result.means = (0.5 * (result.means + result.means.transpose())).eval();
    result.gradients = (0.5 * (result.gradients + result.gradients.transpose())).eval();
    return result;
}

// Holds that are close together for a smooth energy get large multipliers of alternating signs, whose responses cancel.
// Then their loads are summed first, and answered by one solve: what cancels does so before any round-off is spread.
Eigen::MatrixXd FieldResponses::field_of(const ResponseSystem::Multipliers& multipliers, bool small) const {
    constexpr double much_cancelled = 1e5;
    Eigen::MatrixXd field = Eigen::MatrixXd::Zero(inverse_->vertices(), 2);
    double parts = 0;
    for (std::size_t h = 0; h < responses_.size(); ++h) {
        const Response& response = responses_[h];
        const Eigen::MatrixX2d of = multipliers_of(multipliers, h);
        for (Eigen::Index i = 0; i < of.rows(); ++i) {
            if (of.row(i).isZero(0)) continue;
            field.noalias() += response.fields->col(i) * of.row(i);
            parts += response.largest(i) * of.row(i).norm();
        }
    }
    if (small || parts <= much_cancelled * field.cwiseAbs().maxCoeff()) return field;
    Eigen::MatrixXd loads = Eigen::MatrixXd::Zero(field.rows(), 2);
    for (std::size_t h = 0; h < responses_.size(); ++h) {
        const Eigen::MatrixX2d of = multipliers_of(multipliers, h);
        for (Eigen::Index i = 0; i < of.rows(); ++i) {
            for (const auto& [vertex, coefficient] : responses_[h].rows[static_cast<std::size_t>(i)]) {
                loads.row(vertex) += coefficient * of.row(i);
            }
        }
    }
    return inverse_->respond(loads);
}

// Of a hold's rows, (re, im) each.
Eigen::MatrixX2d FieldResponses::multipliers_of(const ResponseSystem::Multipliers& multipliers,
                                                std::size_t hold) const {
    const Response& response = responses_[hold];
    Eigen::MatrixX2d result(static_cast<Eigen::Index>(response.rows.size()), 2);
    const Complex mean = multipliers.means(static_cast<Eigen::Index>(hold));
    result.row(0) << mean.real(), mean.imag();
    for (Eigen::Index i = 1; i < result.rows(); ++i) {
        const Complex slope = multipliers.gradients(2 * response.gradient + i - 1);
        result.row(i) << slope.real(), slope.imag();
    }
    return result;
}

// One pass of `bring_to`; what round-off leaves is left for the next.
void FieldResponses::correct(std::vector<FieldGoal>& goals, bool again, Eigen::VectorXcd& u) const {
    Eigen::VectorXcd means(static_cast<Eigen::Index>(goals.size()));
    std::vector<GradientGoal> gradients;
    std::vector<std::size_t> hold_of;
    for (std::size_t h = 0; h < goals.size(); ++h) {
        const Response& response = responses_[h];
        const FieldGoal& goal = goals[h];
        means(static_cast<Eigen::Index>(h)) = goal.mean - row_times(response.rows[0], u);
        const double radius = response.radius_px;
        if (response.gradient < 0) continue;
        if (goal.turn || goal.scale) {
            gradients.push_back({response.gradient, GradientGoal::Row::turn, radius + response.turn(u),
                                 radius * goal.turn.value_or(0.0), goal.turn ? 0 : radius * *goal.scale});
            hold_of.push_back(h);
        }
        if (goal.shear) {
            gradients.push_back(
                {response.gradient, GradientGoal::Row::shear, response.shear(u), radius * *goal.shear, 0});
            hold_of.push_back(h);
        }
    }
    const ResponseSystem::Multipliers multipliers = system_->solve(means, gradients);
    for (std::size_t i = 0; i < gradients.size(); ++i) {
        FieldGoal& goal = goals[hold_of[i]];
        if (gradients[i].scale > 0) goal.turn = gradients[i].wanted / responses_[hold_of[i]].radius_px;
    }
    const Eigen::MatrixX2d sum = field_of(multipliers, again);
    for (Eigen::Index v = 0; v < u.size(); ++v) {
        u(v) += Complex(sum(v, 0), sum(v, 1));
        const int constant = constant_of_[static_cast<std::size_t>(v)];
        if (constant >= 0) u(v) += multipliers.constants(constant);
    }
}

void FieldResponses::bring_to(std::vector<FieldGoal>& goals, Eigen::VectorXcd& u) const {
    if (goals.empty()) return;
    correct(goals, false, u);
    correct(goals, true, u);
}

double FieldResponses::largest_error(const std::vector<FieldGoal>& goals, const Eigen::VectorXcd& u) const {
    double largest = 0;
    for (std::size_t h = 0; h < goals.size(); ++h) {
        const Response& response = responses_[h];
        const FieldGoal& goal = goals[h];
        largest = std::max(largest, std::abs(goal.mean - row_times(response.rows[0], u)));
        if (response.gradient < 0) continue;
        const double radius = response.radius_px;
        if (goal.turn) largest = std::max(largest, std::abs(radius * *goal.turn - radius - response.turn(u)));
        if (goal.shear) largest = std::max(largest, std::abs(radius * *goal.shear - response.shear(u)));
    }
    return largest;
}

}  // namespace puppetwarp
