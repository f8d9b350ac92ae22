#include <puppetwarp/deform/field_energy.h>

#include <algorithm>

namespace puppetwarp {

double FieldEnergy::operator()(const Eigen::VectorXcd& u) const {
    // u^H L (M^-1 L)^(order - 1) u = a^H L b or a^H M b with a, b = (M^-1 L)^i u.
    const Eigen::VectorXd inverse_M = M.unaryExpr([](double m) { return m > 0 ? 1 / m : 0; });
    // Seen from a vertex: rows of L sum to 0, and a common move would leave what round-off makes of it.
    const Eigen::VectorXcd seen = (u.array() - u(0)).matrix();
    Eigen::VectorXcd power = seen;
    for (int i = 0; i < order / 2; ++i) power = inverse_M.cwiseProduct(L * power).eval();
    double energy = order % 2 == 1 ? power.dot(L * power).real() : power.dot(M.cwiseProduct(power)).real();
    energy *= weight;
    if (first_order > 0) energy += first_order * seen.dot((K.size() > 0 ? K : L) * seen).real();
    return std::max(0.0, energy);
}

}  // namespace puppetwarp
