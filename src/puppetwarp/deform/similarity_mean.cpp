#include <puppetwarp/deform/similarity_mean.h>

#include <algorithm>
#include <cmath>

namespace puppetwarp {

namespace {

using Complex = std::complex<double>;

// Below this the quotients are taken from their series, whose first term left out is smaller than round-off; above,
// differences of products lose no more than two digits.
constexpr double small = 0.02;
// At the pole itself the quotient is only large: there the mean is as the motion that is so far away.
constexpr double least_sine = 1e-12;

// With half = l / 2: g(l) = half / sinh(half) e^-half, and e^-half is a factor of each motion times one that is common
// to all, which cancels. What is left is one quotient a motion, and sinh(half) is a difference of products of what is
// known of each motion and of the mean: one exponential a vertex.

// Rotations: the quotient is real, half / sin(half) of half the angle.
class Angles {
public:
    using Quotient = double;
    static double of(const Similarity& motion) { return motion.log.imag(); }

    void settle(double mean) {
        mean_ = mean;
        cos_ = std::cos(mean / 2);
        sin_ = std::sin(mean / 2);
    }
    // \param exp_half  e^(i angle / 2).
    double quotient(double angle, const Complex& exp_half) const {
        const double half = (angle - mean_) / 2;
        if (std::abs(half) > small) {
            const double sine = exp_half.imag() * cos_ - exp_half.real() * sin_;
            return half / (std::abs(sine) > least_sine ? sine : least_sine);
        }
        const double square = half * half;
        return 1 + square * (1.0 / 6 + square * (7.0 / 360 + square * (31.0 / 15120)));
    }
    Complex factor() const { return {cos_ * cos_ - sin_ * sin_, 2 * cos_ * sin_}; }
    Complex exp_half() const { return {cos_, sin_}; }

private:
    double mean_ = 0, cos_ = 1, sin_ = 0;
};

class Logarithms {
public:
    using Quotient = Complex;
    static Complex of(const Similarity& motion) { return motion.log; }

    void settle(const Complex& mean) {
        mean_ = mean;
        exp_half_ = std::exp(mean / 2.0);
    }
    // \param exp_half  e^(log / 2).
    Complex quotient(const Complex& log, const Complex& exp_half) const {
        const Complex half = (log - mean_) / 2.0;
        if (std::norm(half) > small * small) {
            const Complex ratio = exp_half / exp_half_;
            const Complex twice_sine = ratio - 1.0 / ratio;
            return 2.0 * half / (std::norm(twice_sine) > least_sine * least_sine ? twice_sine : Complex(least_sine));
        }
        const Complex square = half * half;
        return 1.0 - square * (1.0 / 6 - square * (7.0 / 360 - square * (31.0 / 15120)));
    }
    Complex factor() const { return exp_half_ * exp_half_; }
    Complex exp_half() const { return exp_half_; }

private:
    Complex mean_, exp_half_ = 1;
};

// What is known of each motion.
template <typename Log>
struct Column {
    decltype(Log::of({})) log;
    Complex exp_half;       // e^(log / 2)
    Complex inverse;        // e^(-log / 2)
    Complex inverse_shift;  // times the shift
};

Complex times(double quotient, const Complex& z) {
    return {quotient * z.real(), quotient * z.imag()};
}

Complex times(const Complex& quotient, const Complex& z) {
    return quotient * z;
}

template <typename Log>
BlendedPositions mean_of(const WeightRows& W, const Eigen::VectorXcd& z, const std::vector<Similarity>& motions) {
    std::vector<Column<Log>> columns;
    columns.reserve(motions.size());
    for (const Similarity& motion : motions) {
        const Complex inverse = std::exp(-motion.log / 2.0);
        columns.push_back({Log::of(motion), std::exp(motion.log / 2.0), inverse, inverse * motion.shift});
    }
    BlendedPositions result;
    result.x.resize(z.size());
    Log mean;
    for (Eigen::Index v = 0; v < z.size(); ++v) {
        decltype(Log::of({})) log{};
        for (WeightRows::InnerIterator w(W, v); w; ++w)
            log += w.value() * columns[static_cast<std::size_t>(w.col())].log;
        mean.settle(log);
        Complex shift = 0, sum = 0;
        for (WeightRows::InnerIterator w(W, v); w; ++w) {
            const Column<Log>& column = columns[static_cast<std::size_t>(w.col())];
            const typename Log::Quotient share = w.value() * mean.quotient(column.log, column.exp_half);
            shift += times(share, column.inverse_shift);
            sum += times(share, column.inverse);
        }
        result.unsteady.look_at(v, (mean.exp_half() * sum).real());
        if (std::norm(sum) == 0) sum = 1;  // no mean: anything finite
        result.x(v) = mean.factor() * z(v) + shift / sum;
    }
    return result;
}

}  // namespace

BlendedPositions similarity_mean(const WeightRows& W, const Eigen::VectorXcd& z,
                                 const std::vector<Similarity>& motions) {
    const auto rotates = [](const Similarity& each) { return each.log.real() == 0; };
    return std::all_of(motions.begin(), motions.end(), rotates) ? mean_of<Angles>(W, z, motions)
                                                                : mean_of<Logarithms>(W, z, motions);
}

}  // namespace puppetwarp
