#include <puppetwarp/deform/field_inverse.h>

#include <puppetwarp/base/errors.h>
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

// The same for first_order L + weight L M^-1 L, which is L M^-1 (first_order M + weight L).
class ShellInverse final : public FieldInverse {
public:
    ShellInverse(const FieldEnergy& energy, const Eigen::VectorXi& component)
        : M_(energy.M), means_(component, energy.M), inverse_(energy.L, component), shift_(shifted_factor(energy)) {}

    Eigen::Index vertices() const override { return M_.size(); }

    Eigen::MatrixXd respond(const Eigen::MatrixXd& loads) const override {
        Eigen::MatrixXd x = loads;
        means_.remove_from_loads(x);
        x = inverse_ * x;
        means_.remove(x);
        x = M_.asDiagonal() * x;
        shift_.solve_in_place(x);
        means_.remove(x);
        return x;
    }

    Eigen::MatrixXd extend(const Eigen::MatrixXd& values) const override {
        return Eigen::MatrixXd::Zero(values.rows(), values.cols());
    }

private:
    static CholeskyFactor shifted_factor(const FieldEnergy& energy) {
        SparseMatrix diagonal(energy.L.rows(), energy.L.cols());
        diagonal.setIdentity();
        // A vertex of no triangle has no mass; its displacement is 0.
        for (Eigen::Index v = 0; v < energy.M.size(); ++v) {
            diagonal.coeffRef(v, v) = energy.M(v) > 0 ? energy.first_order * energy.M(v) : 1;
        }
        const SparseMatrix sum = energy.weight * energy.L + diagonal;
        const SparseMatrix lower = sum.triangularView<Eigen::Lower>();
        std::optional<CholeskyFactor> factor = CholeskyPattern(lower).factorise(lower);
        if (!factor) {
            throw InvalidInput("mesh", "its triangles are too thin or too different in size to compute with",
                               "use a mesh with better triangles");
        }
        return std::move(*factor);
    }

    Eigen::VectorXd M_;
    ComponentMeans means_;
    GroundedInverse inverse_;
    CholeskyFactor shift_;
};

}  // namespace

std::unique_ptr<FieldInverse> make_field_inverse(const FieldEnergy& energy, const Eigen::VectorXi& component,
                                                 const std::vector<bool>& held) {
    const bool none_held = std::find(held.begin(), held.end(), true) == held.end();
    if (none_held && !(energy.first_order > 0)) return std::make_unique<PowerInverse>(energy, component);
    if (none_held && energy.K.size() == 0) return std::make_unique<ShellInverse>(energy, component);
    return std::make_unique<MixedInverse>(energy, component, held);
}

ComponentMeans::ComponentMeans(const Eigen::VectorXi& component, const Eigen::VectorXd& weight)
    : component_(component), count_(component.size() == 0 ? 0 : component.maxCoeff() + 1), weight_(weight) {
    Eigen::VectorXd total = Eigen::VectorXd::Zero(count_);
    for (Eigen::Index v = 0; v < weight.size(); ++v) total(component(v)) += weight(v);
    for (Eigen::Index v = 0; v < weight.size(); ++v) {
        // A vertex of no triangle is a component of no area.
        weight_(v) = total(component(v)) > 0 ? weight(v) / total(component(v)) : 1;
    }
}

void ComponentMeans::remove(Eigen::MatrixXd& x) const {
    for (Eigen::Index c = 0; c < x.cols(); ++c) {
        if (count_ == 1) {
            x.col(c).array() -= weight_.dot(x.col(c));
            continue;
        }
        Eigen::VectorXd mean = Eigen::VectorXd::Zero(count_);
        for (Eigen::Index v = 0; v < x.rows(); ++v) mean(component_(v)) += weight_(v) * x(v, c);
        for (Eigen::Index v = 0; v < x.rows(); ++v) x(v, c) -= mean(component_(v));
    }
}

void ComponentMeans::remove_from_loads(Eigen::MatrixXd& r) const {
    for (Eigen::Index c = 0; c < r.cols(); ++c) {
        Eigen::VectorXd sum = Eigen::VectorXd::Zero(count_);
        for (Eigen::Index v = 0; v < r.rows(); ++v) sum(component_(v)) += r(v, c);
        for (Eigen::Index v = 0; v < r.rows(); ++v) r(v, c) -= weight_(v) * sum(component_(v));
    }
}

}  // namespace puppetwarp
