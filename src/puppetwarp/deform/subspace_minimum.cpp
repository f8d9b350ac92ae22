#include <puppetwarp/deform/subspace_arap.h>

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

namespace puppetwarp {

namespace {

using Complex = std::complex<double>;

// What may be left to gain, as a share of twice the area, where the energy itself is 0: the square of a strain of
// a millionth.
constexpr double floor_share = 1e-12;
// Columns whose unknowns the energy does not feel (their weights are 0 beside the vertex that they hold) leave them.
constexpr double least_stiffness = 1e-10;
constexpr int most_halvings = 40;

// The energy and what its derivatives need, at one place.
struct Evaluation {
    Eigen::VectorXcd d;
    Eigen::VectorXcd force;  // K d
    Eigen::VectorXcd sums;   // area + S d
    Eigen::VectorXcd rotations;
    double energy = 0;
};

class Minimiser {
public:
    Minimiser(const SubspaceArap& arap, const std::vector<SubspaceUnknown>& unknowns)
        : arap_(arap), unknowns_(unknowns), count_(static_cast<Eigen::Index>(unknowns.size())) {}

    //! \param rotations  units, or empty for the best.
    Evaluation evaluate(const Eigen::VectorXcd& d, const Eigen::VectorXcd& rotations) const;
    //! The step and what it would gain; 0 where there is nothing to gain.
    struct Step {
        Eigen::VectorXd y;
        double gain = 0;
    };
    Step newton_step(const Evaluation& at) const;
    //! For constant rotations.
    Step global_step(const Evaluation& at) const;
    Eigen::VectorXcd moved(const Eigen::VectorXcd& d, const Eigen::VectorXd& y) const;

private:
    // Where the unknowns move d, and how: derivatives by the unknowns are Re(conj(factor) derivative by the entry).
    Eigen::VectorXcd factors(const Evaluation& at) const;
    Eigen::VectorXcd gradient(const Evaluation& at) const;
    Eigen::MatrixXd global_hessian(const Evaluation& at, const Eigen::VectorXcd& f, const Eigen::VectorXcd& g) const;
    void subtract_turning(const Evaluation& at, const Eigen::VectorXcd& f, Eigen::MatrixXd& H) const;
    static std::optional<Step> solved(const Eigen::MatrixXd& H, const Eigen::VectorXd& gradient);
    Eigen::VectorXd by_unknowns(const Eigen::VectorXcd& f, const Eigen::VectorXcd& g) const;
    Eigen::Index entry(Eigen::Index i) const { return unknowns_[static_cast<std::size_t>(i)].entry; }

    const SubspaceArap& arap_;
    const std::vector<SubspaceUnknown>& unknowns_;
    Eigen::Index count_;
};

Evaluation Minimiser::evaluate(const Eigen::VectorXcd& d, const Eigen::VectorXcd& rotations) const {
    Evaluation at;
    at.d = d;
    at.force = arap_.K * d;
    const Eigen::VectorXcd own = arap_.S * d;
    at.sums = arap_.area + own;
    at.rotations = rotations.size() > 0 ? rotations : at.sums;
    at.energy = d.dot(at.force).real();
    for (Eigen::Index c = 0; c < own.size(); ++c) {
        Complex& r = at.rotations(c);
        const double length = std::abs(r);
        r = length > 0 ? r / length : Complex(1);
        const Complex off = 1.0 - r;
        at.energy += 4 * (off.real() * own(c).real() + off.imag() * own(c).imag()) + 2 * arap_.area(c) * std::norm(off);
    }
    return at;
}

Eigen::VectorXcd Minimiser::factors(const Evaluation& at) const {
    Eigen::VectorXcd f(count_);
    for (Eigen::Index i = 0; i < count_; ++i) {
        const SubspaceUnknown& unknown = unknowns_[static_cast<std::size_t>(i)];
        f(i) = unknown.factor ? *unknown.factor : Complex(0, 1) * (1.0 + at.d(unknown.entry));
    }
    return f;
}

// Half the derivative by d: the energy changes by 2 Re(conj(g) change).
Eigen::VectorXcd Minimiser::gradient(const Evaluation& at) const {
    const Eigen::VectorXcd off = (1.0 - at.rotations.array()).matrix();
    return at.force + 2 * (arap_.S.adjoint() * off);
}

Eigen::VectorXd Minimiser::by_unknowns(const Eigen::VectorXcd& f, const Eigen::VectorXcd& g) const {
    Eigen::VectorXd result(count_);
    for (Eigen::Index i = 0; i < count_; ++i) result(i) = (std::conj(f(i)) * g(entry(i))).real();
    return result;
}

Eigen::MatrixXd Minimiser::global_hessian(const Evaluation& at, const Eigen::VectorXcd& f,
                                          const Eigen::VectorXcd& g) const {
    Eigen::MatrixXd H(count_, count_);
    for (Eigen::Index j = 0; j < count_; ++j) {
        for (Eigen::Index i = j; i < count_; ++i) {
            const Complex both = std::conj(f(i)) * f(j);
            const Complex& k = arap_.K(entry(i), entry(j));
            H(i, j) = both.real() * k.real() - both.imag() * k.imag();
        }
        // On a circle the way itself bends.
        if (unknowns_[static_cast<std::size_t>(j)].factor) continue;
        H(j, j) += std::max(0.0, -(std::conj(g(entry(j))) * (1.0 + at.d(entry(j)))).real());
    }
    H.diagonal().array() += least_stiffness * H.trace() / static_cast<double>(count_);
    return H;
}

// What the rotations give way when the groups' sums move across them.
void Minimiser::subtract_turning(const Evaluation& at, const Eigen::VectorXcd& f, Eigen::MatrixXd& H) const {
    Eigen::MatrixXd across(count_, at.sums.size());
    for (Eigen::Index c = 0; c < at.sums.size(); ++c) {
        const double length = std::abs(at.sums(c));
        if (!(length > 0)) {
            across.col(c).setZero();
            continue;
        }
        const Complex turned_back = std::conj(at.rotations(c)) * std::sqrt(2 / length);
        for (Eigen::Index i = 0; i < count_; ++i) {
            const Complex moved = arap_.S(c, entry(i)) * f(i);
            across(i, c) = turned_back.real() * moved.imag() + turned_back.imag() * moved.real();
        }
    }
    H.selfadjointView<Eigen::Lower>().rankUpdate(across, -1);
}

std::optional<Minimiser::Step> Minimiser::solved(const Eigen::MatrixXd& H, const Eigen::VectorXd& gradient) {
    const Eigen::LLT<Eigen::MatrixXd> factor(H);
    if (factor.info() != Eigen::Success) return {};
    Step step{factor.solve(-gradient), 0};
    step.gain = -gradient.dot(step.y);
    return step;
}

Minimiser::Step Minimiser::global_step(const Evaluation& at) const {
    const Eigen::VectorXcd f = factors(at), g = gradient(at);
    const auto step = solved(global_hessian(at, f, g), by_unknowns(f, g));
    return step ? *step : Step{Eigen::VectorXd::Zero(count_), 0};  // the energy feels none of the unknowns
}

Minimiser::Step Minimiser::newton_step(const Evaluation& at) const {
    const Eigen::VectorXcd f = factors(at), g = gradient(at);
    Eigen::MatrixXd H = global_hessian(at, f, g);
    subtract_turning(at, f, H);
    const auto step = solved(H, by_unknowns(f, g));
    return step ? *step : global_step(at);
}

Eigen::VectorXcd Minimiser::moved(const Eigen::VectorXcd& d, const Eigen::VectorXd& y) const {
    Eigen::VectorXcd to = d;
    for (Eigen::Index i = 0; i < count_; ++i) {
        const auto& factor = unknowns_[static_cast<std::size_t>(i)].factor;
        to(entry(i)) += factor ? y(i) * *factor : (1.0 + d(entry(i))) * (std::polar(1.0, y(i)) - 1.0);
    }
    return to;
}

}  // namespace

SubspaceMinimum minimise(const SubspaceArap& arap, const std::vector<SubspaceUnknown>& unknowns,
                         const Eigen::VectorXcd& start, const Eigen::VectorXcd& rotations, double tolerance,
                         int max_iterations) {
    const Minimiser minimiser(arap, unknowns);
    Evaluation at = minimiser.evaluate(start, rotations);
    if (rotations.size() > 0 && !unknowns.empty()) {
        at.d = minimiser.moved(at.d, minimiser.global_step(at).y);
    }
    if (rotations.size() > 0) at = minimiser.evaluate(at.d, {});
    SubspaceMinimum result;
    result.energies = {at.energy};
    result.converged = unknowns.empty();
    const double floor = floor_share * 2 * arap.area.sum();
    while (!result.converged && result.iterations < max_iterations) {
        const Minimiser::Step step = minimiser.newton_step(at);
        ++result.iterations;
        result.converged = step.gain <= tolerance * std::max(at.energy, floor);
        double share = 1;
        for (int halvings = 0;; ++halvings, share /= 2) {
            const Evaluation there = minimiser.evaluate(minimiser.moved(at.d, share * step.y), {});
            if (there.energy <= at.energy - 1e-4 * share * step.gain) {
                at = there;
                break;
            }
            // No shorter step helps once the energy's own round-off is in the way.
            if (result.converged || halvings == most_halvings) {
                result.converged = true;
                break;
            }
        }
        result.energies.push_back(at.energy);
    }
    result.d = at.d;
    return result;
}

}  // namespace puppetwarp
