#include <puppetwarp/deform/similarity_mean.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

namespace puppetwarp {

namespace {

using Complex = std::complex<double>;

// Vertices are worked on several at a time, one a lane: each lane does what it would alone.
constexpr Eigen::Index width = 8;
using Lanes = Eigen::Array<double, width, 1>;
struct ComplexLanes {
    Lanes re = Lanes::Zero(), im = Lanes::Zero();
};

// The weights of these vertices by columns, ascending; a lane that has none of a column has 0.
class WeightPanel {
public:
    struct Entry {
        std::size_t column;
        Lanes w;
    };

    void read(const WeightRows& W, Eigen::Index first, Eigen::Index count) {
        entries_.clear();
        const int* const start = W.outerIndexPtr() + first;
        const int* const column = W.innerIndexPtr();
        if (count == width && alike(start, column)) {
            for (int e = start[0]; e < start[1]; ++e) {
                Lanes& w = add(column[e]);
                for (Eigen::Index k = 0; k < width; ++k) w(k) = W.valuePtr()[start[k] + e - start[0]];
            }
            return;
        }
        std::array<int, width> next{}, end{};
        std::copy_n(start, count, next.begin());
        std::copy_n(start + 1, count, end.begin());
        constexpr int none = std::numeric_limits<int>::max();
        const auto column_of = [&](std::size_t k) { return next[k] < end[k] ? column[next[k]] : none; };
        for (;;) {
            int least = none;
            for (std::size_t k = 0; k < width; ++k) least = std::min(least, column_of(k));
            if (least == none) return;
            Lanes& w = add(least);
            for (std::size_t k = 0; k < width; ++k) {
                if (column_of(k) == least) w(static_cast<Eigen::Index>(k)) = W.valuePtr()[next[k]++];
            }
        }
    }
    const std::vector<Entry>& entries() const { return entries_; }

private:
    // Whether all rows have the same columns, as where weights are nowhere 0.
    static bool alike(const int* start, const int* column) {
        for (int k = 1; k < width; ++k) {
            if (!std::equal(column + start[0], column + start[1], column + start[k], column + start[k + 1]))
                return false;
        }
        return true;
    }
    Lanes& add(int column) { return entries_.emplace_back(Entry{static_cast<std::size_t>(column), Lanes::Zero()}).w; }

    std::vector<Entry> entries_;
};

// What is known of each motion.
struct Column {
    Complex log, exp, shift;
};

// Motions that turn. With T = e^log of one of them and t that of the mean, g(log_j - log) = t (log_j - log) / (T - t);
// the t is common to all and left out.
class Turning {
public:
    void add_to_mean(const Lanes& w, const Column& column) {
        log_.re += w * column.log.real();
        log_.im += w * column.log.imag();
    }
    void settle() {
        for (Eigen::Index k = 0; k < width; ++k) {
            const double scale = std::exp(log_.re(k)), angle = log_.im(k);
            const double cos = std::cos(angle), sin = std::sin(angle);
            exp_.re(k) = scale * cos;
            exp_.im(k) = scale * sin;
        }
        // At the pole itself g is only large: there the mean is as the motion that is so far away.
        constexpr double least = 1e-12;
        least_norm_ = least * least * (exp_.re.square() + exp_.im.square());
    }
    void add(const Lanes& w, const Column& column) {
        ComplexLanes over, under;
        over.re = column.log.real() - log_.re;
        over.im = column.log.imag() - log_.im;
        under.re = column.exp.real() - exp_.re;
        under.im = column.exp.imag() - exp_.im;
        const Lanes square = over.re.square() + over.im.square();
        if (square.minCoeff() < small * small) take_series(square, over, under);
        const Lanes share = w / (under.re.square() + under.im.square()).max(least_norm_);
        const Lanes re = share * (over.re * under.re + over.im * under.im);
        const Lanes im = share * (over.im * under.re - over.re * under.im);
        sum_.re += re;
        sum_.im += im;
        shift_.re += re * column.shift.real() - im * column.shift.imag();
        shift_.im += re * column.shift.imag() + im * column.shift.real();
    }
    Complex factor(Eigen::Index k) const { return {exp_.re(k), exp_.im(k)}; }
    Complex shift(Eigen::Index k) const {
        const double norm = sum_.re(k) * sum_.re(k) + sum_.im(k) * sum_.im(k);
        if (!(norm > 0)) return 0;  // no mean: anything finite
        return {(shift_.re(k) * sum_.re(k) + shift_.im(k) * sum_.im(k)) / norm,
                (shift_.im(k) * sum_.re(k) - shift_.re(k) * sum_.im(k)) / norm};
    }
    double steadiness(Eigen::Index k) const { return exp_.re(k) * sum_.re(k) - exp_.im(k) * sum_.im(k); }

private:
    // Below this T - t would lose more than two digits.
    static constexpr double small = 0.06;

    // Near 0 the quotient d / (e^d - 1) from its series, whose first term left out is smaller than round-off.
    void take_series(const Lanes& squared, ComplexLanes& over, ComplexLanes& under) const {
        for (Eigen::Index k = 0; k < width; ++k) {
            if (!(squared(k) < small * small)) continue;
            const Complex d(over.re(k), over.im(k)), square = d * d;
            const Complex g = 1.0 - 0.5 * d + square * (1.0 / 12 - square * (1.0 / 720 - square * (1.0 / 30240)));
            over.re(k) = g.real();
            over.im(k) = g.imag();
            under.re(k) = exp_.re(k);
            under.im(k) = exp_.im(k);
        }
    }

    ComplexLanes log_, exp_;
    Lanes least_norm_;
    ComplexLanes sum_, shift_;
};

// Motions that only scale: g is real.
class Scaling {
public:
    void add_to_mean(const Lanes& w, const Column& column) { log_ += w * column.log.real(); }
    void settle() {
        for (Eigen::Index k = 0; k < width; ++k) exp_(k) = std::exp(log_(k));
    }
    void add(const Lanes& w, const Column& column) {
        const Lanes d = column.log.real() - log_, square = d.square();
        // d / 2 coth(d / 2) by Lambert's continued fraction, right to round-off up to 1.
        const Lanes over = 135135 + square * (15592.5 + square * (196.875 + square * 0.4375));
        const Lanes under = 135135 + square * (4331.25 + square * (23.625 + square * 0.015625));
        Lanes g = over / under - 0.5 * d;
        if (square.maxCoeff() > 1) {
            for (Eigen::Index k = 0; k < width; ++k) {
                if (square(k) > 1) g(k) = d(k) / std::expm1(d(k));
            }
        }
        g *= w;
        sum_ += g;
        shift_.re += g * column.shift.real();
        shift_.im += g * column.shift.imag();
    }
    Complex factor(Eigen::Index k) const { return exp_(k); }
    Complex shift(Eigen::Index k) const {
        if (sum_(k) == 0) return 0;  // no weights: anything finite
        return {shift_.re(k) / sum_(k), shift_.im(k) / sum_(k)};
    }
    double steadiness(Eigen::Index k) const { return sum_(k); }

private:
    Lanes log_ = Lanes::Zero(), exp_, sum_ = Lanes::Zero();
    ComplexLanes shift_;
};

template <typename Mean>
BlendedPositions mean_of(const WeightRows& W, const Eigen::VectorXcd& z, const std::vector<Similarity>& motions) {
    std::vector<Column> columns;
    columns.reserve(motions.size());
    for (const Similarity& motion : motions) columns.push_back({motion.log, std::exp(motion.log), motion.shift});
    BlendedPositions result;
    result.x.resize(z.size());
    WeightPanel panel;
    for (Eigen::Index first = 0; first < z.size(); first += width) {
        const Eigen::Index count = std::min(width, z.size() - first);
        panel.read(W, first, count);
        Mean mean;
        for (const auto& [column, w] : panel.entries()) mean.add_to_mean(w, columns[column]);
        mean.settle();
        for (const auto& [column, w] : panel.entries()) mean.add(w, columns[column]);
        for (Eigen::Index k = 0; k < count; ++k) {
            result.unsteady.look_at(first + k, mean.steadiness(k));
            result.x(first + k) = mean.factor(k) * z(first + k) + mean.shift(k);
        }
    }
    return result;
}

}  // namespace

BlendedPositions similarity_mean(const WeightRows& W, const Eigen::VectorXcd& z,
                                 const std::vector<Similarity>& motions) {
    assert(W.isCompressed() && W.rows() == z.size());
    const auto only_scales = [](const Similarity& each) { return each.log.imag() == 0; };
    return std::all_of(motions.begin(), motions.end(), only_scales) ? mean_of<Scaling>(W, z, motions)
                                                                    : mean_of<Turning>(W, z, motions);
}

}  // namespace puppetwarp
