#include <puppetwarp/deform/field_inverse.h>

#include <puppetwarp/deform/mixed_inverse.h>
#include <puppetwarp/solve/grounded_inverse.h>

#include <algorithm>
#include <utility>

namespace puppetwarp {

namespace {

// Without held vertices each level of the mixed system has the same boundary conditions, and the inverse is that of L
// taken `order` times.
class PowerInverse final : public FieldInverse {
public:
    PowerInverse(const FieldEnergy& energy, const Eigen::VectorXi& component)
        : order_(energy.order),
          weight_(energy.weight),
          M_(energy.M),
          means_(component, energy.M),
          inverse_(energy.L, component) {}

    Eigen::Index vertices() const override { return M_.size(); }

    Eigen::MatrixXd respond(const Eigen::MatrixXd& loads) const override {
        Eigen::MatrixXd x = loads / weight_;
        means_.remove_from_loads(x);
        for (int power = 1;; ++power) {
            x = inverse_ * x;
            means_.remove(x);
            if (power == order_) return x;
            x = M_.asDiagonal() * x;
        }
    }

    Eigen::MatrixXd extend(const Eigen::MatrixXd& values) const override {
        return Eigen::MatrixXd::Zero(values.rows(), values.cols());
    }

private:
    int order_;
    double weight_;
    Eigen::VectorXd M_;
    ComponentMeans means_;
    GroundedInverse inverse_;
};

}  // namespace

std::unique_ptr<FieldInverse> make_field_inverse(const FieldEnergy& energy, const Eigen::VectorXi& component,
                                                 const std::vector<bool>& held) {
    const bool none_held = std::find(held.begin(), held.end(), true) == held.end();
    if (none_held && !(energy.first_order > 0)) return std::make_unique<PowerInverse>(energy, component);
    return std::make_unique<MixedInverse>(energy, component, held);
}

ComponentMeans::ComponentMeans(const Eigen::VectorXi& component, const Eigen::VectorXd& weight)
    : component_(component), weight_(weight) {
    const Eigen::Index count = component.size() == 0 ? 0 : component.maxCoeff() + 1;
    Eigen::VectorXd total = Eigen::VectorXd::Zero(count);
    for (Eigen::Index v = 0; v < weight.size(); ++v) total(component(v)) += weight(v);
    for (Eigen::Index v = 0; v < weight.size(); ++v) {
        // A vertex of no triangle is a component of no area.
        weight_(v) = total(component(v)) > 0 ? weight(v) / total(component(v)) : 1;
    }
}

void ComponentMeans::remove(Eigen::MatrixXd& x) const {
    const Eigen::Index count = component_.size() == 0 ? 0 : component_.maxCoeff() + 1;
    for (Eigen::Index c = 0; c < x.cols(); ++c) {
        Eigen::VectorXd mean = Eigen::VectorXd::Zero(count);
        for (Eigen::Index v = 0; v < x.rows(); ++v) mean(component_(v)) += weight_(v) * x(v, c);
        for (Eigen::Index v = 0; v < x.rows(); ++v) x(v, c) -= mean(component_(v));
    }
}

void ComponentMeans::remove_from_loads(Eigen::MatrixXd& r) const {
    const Eigen::Index count = component_.size() == 0 ? 0 : component_.maxCoeff() + 1;
    for (Eigen::Index c = 0; c < r.cols(); ++c) {
        Eigen::VectorXd sum = Eigen::VectorXd::Zero(count);
        for (Eigen::Index v = 0; v < r.rows(); ++v) sum(component_(v)) += r(v, c);
        for (Eigen::Index v = 0; v < r.rows(); ++v) r(v, c) -= weight_(v) * sum(component_(v));
    }
}

}  // namespace puppetwarp
