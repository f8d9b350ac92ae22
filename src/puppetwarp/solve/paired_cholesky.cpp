#include <puppetwarp/solve/paired_cholesky.h>

#include <puppetwarp/solve/cholmod_factor.h>

#include <algorithm>
#include <cassert>
#include <complex>
#include <limits>
#include <utility>

namespace puppetwarp {

namespace {

// The pairs' own pattern: an entry for each block.
Eigen::SparseMatrix<double> pair_pattern(const Eigen::SparseMatrix<double>& lower) {
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(static_cast<std::size_t>(lower.nonZeros() / 2));
    for (int column = 0; column < lower.outerSize(); column += 2) {
        for (Eigen::SparseMatrix<double>::InnerIterator it(lower, column); it; ++it) {
            if (it.row() % 2 == 0) entries.emplace_back(static_cast<int>(it.row()) / 2, column / 2, 1.0);
        }
    }
    Eigen::SparseMatrix<double> pairs(lower.rows() / 2, lower.cols() / 2);
    pairs.setFromTriplets(entries.begin(), entries.end());
    return pairs;
}

}  // namespace

// Forward and backward substitution. The numbers of all right-hand sides at a pair lie together.
template <std::size_t count>
void PairedCholeskyFactor::substitute(const std::array<Eigen::VectorXcd*, count>& sides) const {
    using Pairs = std::array<std::array<double, 2>, count>;
    const std::size_t n = order_.size();
    std::vector<Pairs> y(n);
    for (std::size_t j = 0; j < n; ++j) {
        for (std::size_t s = 0; s < count; ++s)
            y[j][s] = {(*sides[s])(order_[j]).real(), (*sides[s])(order_[j]).imag()};
    }
    for (std::size_t j = 0; j < n; ++j) {
        Pairs& own = y[j];
        for (std::size_t s = 0; s < count; ++s) {
            own[s][0] *= diagonal_[3 * j];
            own[s][1] = (own[s][1] - diagonal_[3 * j + 1] * own[s][0]) * diagonal_[3 * j + 2];
        }
        const Pairs x = own;
        for (std::size_t k = first_[j]; k < first_[j + 1]; ++k) {
            const float* m = blocks_[k].at;
            Pairs& to = y[static_cast<std::size_t>(rows_[k])];
            for (std::size_t s = 0; s < count; ++s) {
                to[s][0] -= m[0] * x[s][0] + m[2] * x[s][1];
                to[s][1] -= m[1] * x[s][0] + m[3] * x[s][1];
            }
        }
    }
    for (std::size_t j = n; j-- > 0;) {
        // Four sums a side, so that no addition waits for the one before.
        std::array<std::array<double, 4>, count> sum{};
        for (std::size_t k = first_[j]; k < first_[j + 1]; ++k) {
            const float* m = blocks_[k].at;
            const Pairs& from = y[static_cast<std::size_t>(rows_[k])];
            for (std::size_t s = 0; s < count; ++s) {
                sum[s][0] += m[0] * from[s][0];
                sum[s][1] += m[1] * from[s][1];
                sum[s][2] += m[2] * from[s][0];
                sum[s][3] += m[3] * from[s][1];
            }
        }
        for (std::size_t s = 0; s < count; ++s) {
            std::array<double, 2>& own = y[j][s];
            own[1] = (own[1] - (sum[s][2] + sum[s][3])) * diagonal_[3 * j + 2];
            own[0] = (own[0] - (sum[s][0] + sum[s][1]) - diagonal_[3 * j + 1] * own[1]) * diagonal_[3 * j];
        }
    }
    for (std::size_t j = 0; j < n; ++j) {
        for (std::size_t s = 0; s < count; ++s) (*sides[s])(order_[j]) = {y[j][s][0], y[j][s][1]};
    }
}

void PairedCholeskyFactor::solve_in_place(Eigen::VectorXcd& b) const {
    assert(static_cast<std::size_t>(b.size()) == order_.size());
    substitute<1>({&b});
}

void PairedCholeskyFactor::solve_in_place(Eigen::VectorXcd& b, Eigen::VectorXcd& c) const {
    assert(static_cast<std::size_t>(b.size()) == order_.size() && b.size() == c.size());
    substitute<2>({&b, &c});
}

PairedCholeskyPattern::PairedCholeskyPattern(const Eigen::SparseMatrix<double>& lower)
    : symbolic_(std::make_unique<detail::CholmodFactor>()) {
    const Eigen::SparseMatrix<double> pairs = pair_pattern(lower);
    cholmod_sparse pairs_view = detail::view_of(pairs);
    std::vector<int> pair_order(static_cast<std::size_t>(pairs.rows()));
    if (cholmod_amd(&pairs_view, nullptr, 0, pair_order.data(), &symbolic_->common) == 0) symbolic_->require_success();
    std::vector<int> order;
    order.reserve(2 * pair_order.size());
    for (const int pair : pair_order) {
        order.push_back(2 * pair);
        order.push_back(2 * pair + 1);
    }
    symbolic_->common.method[0].ordering = CHOLMOD_GIVEN;
    cholmod_sparse view = detail::view_of(lower);
    // The second of a pair is the parent of the first in the elimination tree: postordering keeps them together.
    symbolic_->factor = cholmod_analyze_p(&view, order.data(), nullptr, 0, &symbolic_->common);
    symbolic_->require_success();
}

PairedCholeskyPattern::PairedCholeskyPattern(PairedCholeskyPattern&&) noexcept = default;
PairedCholeskyPattern& PairedCholeskyPattern::operator=(PairedCholeskyPattern&&) noexcept = default;
PairedCholeskyPattern::~PairedCholeskyPattern() = default;

std::optional<PairedCholeskyFactor> PairedCholeskyPattern::factorise(const Eigen::SparseMatrix<double>& lower) const {
    detail::CholmodFactor numeric;
    numeric.factor = cholmod_copy_factor(symbolic_->factor, &numeric.common);
    numeric.require_success();
    cholmod_sparse view = detail::view_of(lower);
    cholmod_factorize(&view, numeric.factor, &numeric.common);
    numeric.require_success();
    const cholmod_factor& L = *numeric.factor;
    if (L.minor < L.n) return std::nullopt;

    const int* start = static_cast<const int*>(L.p);
    const int* length = static_cast<const int*>(L.nz);
    const int* row = static_cast<const int*>(L.i);
    const double* value = static_cast<const double*>(L.x);
    const int* order = static_cast<const int*>(L.Perm);
    const std::size_t pairs = L.n / 2;
    PairedCholeskyFactor factor;
    factor.first_.reserve(pairs + 1);
    factor.first_.push_back(0);
    std::size_t entries = 0;
    for (std::size_t j = 0; j < pairs; ++j) entries += static_cast<std::size_t>(length[2 * j + 1]) / 2;
    factor.rows_.reserve(entries);
    factor.blocks_.reserve(entries);
    for (std::size_t j = 0; j < pairs; ++j) {
        // Both columns have the same rows below the diagonal block, and these in pairs.
        const int a = start[2 * j], b = start[2 * j + 1];
        assert(order[2 * j] / 2 == order[2 * j + 1] / 2 && order[2 * j] % 2 == 0);
        assert(length[2 * j] == length[2 * j + 1] + 1);
        factor.order_.push_back(order[2 * j] / 2);
        factor.diagonal_.insert(factor.diagonal_.end(), {1 / value[a], value[a + 1], 1 / value[b]});
        for (int k = 1; k + 1 < length[2 * j + 1]; k += 2) {
            assert(row[b + k] % 2 == 0 && row[b + k + 1] == row[b + k] + 1 && row[a + k + 1] == row[b + k]);
            factor.rows_.push_back(row[b + k] / 2);
            factor.blocks_.push_back({{static_cast<float>(value[a + k + 1]), static_cast<float>(value[a + k + 2]),
                                       static_cast<float>(value[b + k]), static_cast<float>(value[b + k + 1])}});
        }
        factor.first_.push_back(factor.rows_.size());
    }
    return factor;
}

}  // namespace puppetwarp
