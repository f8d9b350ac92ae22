#include <puppetwarp/deform/objective.h>

namespace puppetwarp {

double Objective::spring_value(const Eigen::VectorXcd& x) const {
    if (penalty == 0) return 0;
    double sum = missing(x).squaredNorm();
    for (std::size_t k = 0; k < sprung.size(); ++k)
        sum += std::norm(x(sprung[k]) - anchors(static_cast<Eigen::Index>(k)));
    return penalty / 2 * sum;
}

double Objective::value(const Eigen::VectorXcd& x) const {
    return energy.value(x) + spring_value(x);
}

double Objective::gradient(const Eigen::VectorXcd& x, Eigen::VectorXcd& g) const {
    const double value = energy.gradient(x, g);
    if (!(value < std::numeric_limits<double>::infinity())) return value;
    if (penalty > 0) {
        const Eigen::VectorXd off = missing(x);
        for (std::size_t k = 0; k < conditions.size(); ++k) {
            // Re(conj(d) c x) has the derivative conj(conj(d) c).
            const std::complex<double> pull = -penalty * off(static_cast<Eigen::Index>(k)) * conditions[k].direction;
            for (const auto& [vertex, c] : rows[static_cast<std::size_t>(conditions[k].row)]) {
                g(vertex) += pull * std::conj(c);
            }
        }
        for (std::size_t k = 0; k < sprung.size(); ++k) {
            g(sprung[k]) += penalty * (x(sprung[k]) - anchors(static_cast<Eigen::Index>(k)));
        }
    }
    for (std::size_t v = 0; v < free.size(); ++v) {
        if (!free[v]) g(static_cast<Eigen::Index>(v)) = 0;
    }
    return value + spring_value(x);
}

Eigen::VectorXd Objective::missing(const Eigen::VectorXcd& x) const {
    Eigen::VectorXd off(static_cast<Eigen::Index>(conditions.size()));
    for (Eigen::Index k = 0; k < off.size(); ++k) {
        const Condition& condition = conditions[static_cast<std::size_t>(k)];
        off(k) = condition.value - left_side(condition, rows, x);
    }
    return off;
}

}  // namespace puppetwarp
