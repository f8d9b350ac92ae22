#include <puppetwarp/solve/supernodal_cholesky.h>

#include <puppetwarp/solve/cholmod_factor.h>

#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>
#include <vector>

namespace puppetwarp {

namespace {

using Block = Eigen::Map<Eigen::MatrixXd>;
using ConstBlock = Eigen::Map<const Eigen::MatrixXd>;

// The lower triangle of P A P^T by columns.
struct Permuted {
    std::vector<int> first;  // of each column, and the end
    std::vector<int> row;
    std::vector<double> value;
};

Permuted permuted(const Eigen::SparseMatrix<double>& lower, const std::vector<int>& place) {
    const auto each = [&](const auto& visit) {
        for (Eigen::Index column = 0; column < lower.outerSize(); ++column) {
            for (Eigen::SparseMatrix<double>::InnerIterator it(lower, column); it; ++it) {
                if (it.row() < column) continue;
                const int a = place[static_cast<std::size_t>(it.row())];
                const int b = place[static_cast<std::size_t>(column)];
                visit(std::max(a, b), std::min(a, b), it.value());
            }
        }
    };
    Permuted result;
    result.first.assign(static_cast<std::size_t>(lower.cols()) + 1, 0);
    each([&](int, int column, double) { ++result.first[static_cast<std::size_t>(column) + 1]; });
    for (std::size_t c = 1; c < result.first.size(); ++c) result.first[c] += result.first[c - 1];
    result.row.resize(static_cast<std::size_t>(result.first.back()));
    result.value.resize(result.row.size());
    std::vector<int> next(result.first.begin(), result.first.end() - 1);
    each([&](int row, int column, double value) {
        const auto at = static_cast<std::size_t>(next[static_cast<std::size_t>(column)]++);
        result.row[at] = row;
        result.value[at] = value;
    });
    return result;
}

}  // namespace

// Columns of L by supernodes; each is a dense block, its first rows those of its own columns, of which the upper
// triangle is not used.
struct SupernodalCholesky::Factor {
    std::vector<int> order;       // column of A at each place of P A P^T
    std::vector<int> first;       // column of each supernode, and the end
    std::vector<int> first_row;   // of each supernode, in `rows`, and the end
    std::vector<std::size_t> at;  // of each supernode, in `values`
    std::vector<int> rows;        // ascending within a supernode
    std::vector<double> values;

    std::size_t count() const { return first.size() - 1; }
    int width(std::size_t s) const { return first[s + 1] - first[s]; }
    int height(std::size_t s) const { return first_row[s + 1] - first_row[s]; }
    Block block(std::size_t s) { return {values.data() + at[s], height(s), width(s)}; }
    ConstBlock block(std::size_t s) const { return {values.data() + at[s], height(s), width(s)}; }
};

namespace {

// Left-looking: each supernode takes what the ones before it give, then is finished.
// \tparam Factor  SupernodalCholesky::Factor, which is private.
template <typename Factor>
class Factorisation {
public:
    Factorisation(Factor& factor, const Permuted& A)
        : factor_(factor),
          A_(A),
          local_(factor.order.size()),
          supernode_of_(factor.order.size()),
          next_(factor.count(), -1),
          giver_(factor.count(), -1),
          given_(factor.count(), 0) {
        for (std::size_t s = 0; s < factor.count(); ++s) {
            for (int c = factor.first[s]; c < factor.first[s + 1]; ++c) {
                supernode_of_[static_cast<std::size_t>(c)] = static_cast<int>(s);
            }
        }
    }

    // \return whether all pivots were above 0.
    bool run() {
        for (std::size_t s = 0; s < factor_.count(); ++s) {
            assemble(s);
            for (int d = giver_[s]; d >= 0;) {
                const int following = next_[static_cast<std::size_t>(d)];
                take(s, static_cast<std::size_t>(d));
                d = following;
            }
            if (!finish(s)) return false;
            given_[s] = factor_.width(s);
            queue(s);
        }
        return true;
    }

private:
    const int* rows(std::size_t s) const { return factor_.rows.data() + factor_.first_row[s]; }

    void assemble(std::size_t s) {
        for (int k = 0; k < factor_.height(s); ++k) local_[static_cast<std::size_t>(rows(s)[k])] = k;
        Block block = factor_.block(s);
        for (int c = factor_.first[s]; c < factor_.first[s + 1]; ++c) {
            const auto column = static_cast<std::size_t>(c);
            for (int e = A_.first[column]; e < A_.first[column + 1]; ++e) {
                const auto entry = static_cast<std::size_t>(e);
                block(local_[static_cast<std::size_t>(A_.row[entry])], c - factor_.first[s]) += A_.value[entry];
            }
        }
    }

    // Subtracts from s what the rows of d from the first of s's columns on make of it.
    void take(std::size_t s, std::size_t d) {
        const int begin = given_[d], height = factor_.height(d);
        const int* row = rows(d);
        int end = begin;
        while (end < height && row[end] < factor_.first[s + 1]) ++end;
        const ConstBlock giver(factor_.values.data() + factor_.at[d], height, factor_.width(d));
        const int tall = height - begin, wide = end - begin;
        product_.resize(std::max<Eigen::Index>(product_.size(), static_cast<Eigen::Index>(tall) * wide));
        Block product(product_.data(), tall, wide);
        product.noalias() = giver.bottomRows(tall) * giver.middleRows(begin, wide).transpose();
        Block block = factor_.block(s);
        for (int j = 0; j < wide; ++j) {
            double* column = block.col(row[begin + j] - factor_.first[s]).data();
            for (int i = j; i < tall; ++i) column[local_[static_cast<std::size_t>(row[begin + i])]] -= product(i, j);
        }
        given_[d] = end;
        queue(d);
    }

    bool finish(std::size_t s) {
        Block block = factor_.block(s);
        const int width = factor_.width(s), below = factor_.height(s) - width;
        Eigen::Ref<Eigen::MatrixXd> diagonal = block.topRows(width);
        const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> dense(diagonal);
        if (dense.info() != Eigen::Success) return false;
        if (below > 0) {
            Eigen::Ref<Eigen::MatrixXd> lower = block.bottomRows(below);
            diagonal.transpose().template triangularView<Eigen::Upper>().template solveInPlace<Eigen::OnTheRight>(
                lower);
        }
        return true;
    }

    // Hands a supernode on to the one that its next row belongs to.
    void queue(std::size_t d) {
        if (given_[d] == factor_.height(d)) return;
        const auto taker = static_cast<std::size_t>(supernode_of_[static_cast<std::size_t>(rows(d)[given_[d]])]);
        next_[d] = giver_[taker];
        giver_[taker] = static_cast<int>(d);
    }

    Factor& factor_;
    const Permuted& A_;
    std::vector<int> local_;         // row of L -> row of the block at work
    std::vector<int> supernode_of_;  // column -> supernode
    std::vector<int> next_, giver_;  // lists of those that still give to a supernode
    std::vector<int> given_;         // of each supernode, how many rows it has given
    Eigen::VectorXd product_;
};

}  // namespace

SupernodalCholesky::SupernodalCholesky(std::unique_ptr<const Factor> factor) : factor_(std::move(factor)) {}
SupernodalCholesky::SupernodalCholesky(SupernodalCholesky&&) noexcept = default;
SupernodalCholesky& SupernodalCholesky::operator=(SupernodalCholesky&&) noexcept = default;
SupernodalCholesky::~SupernodalCholesky() = default;

std::optional<SupernodalCholesky> SupernodalCholesky::factorise(const Eigen::SparseMatrix<double>& lower) {
    detail::CholmodFactor symbolic;
    symbolic.common.supernodal = CHOLMOD_SUPERNODAL;
    cholmod_sparse view = detail::view_of(lower);
    symbolic.factor = cholmod_analyze(&view, &symbolic.common);
    symbolic.require_success();
    const cholmod_factor& L = *symbolic.factor;
    const auto integers = [](const void* from, std::size_t count) {
        const int* values = static_cast<const int*>(from);
        return std::vector<int>(values, values + count);
    };
    auto factor = std::make_unique<Factor>();
    factor->order = integers(L.Perm, L.n);
    factor->first = integers(L.super, L.nsuper + 1);
    factor->first_row = integers(L.pi, L.nsuper + 1);
    factor->rows = integers(L.s, static_cast<std::size_t>(factor->first_row.back()));
    std::size_t size = 0;
    for (std::size_t s = 0; s < factor->count(); ++s) {
        factor->at.push_back(size);
        size += static_cast<std::size_t>(factor->height(s)) * static_cast<std::size_t>(factor->width(s));
    }
    factor->values.assign(size, 0);
    std::vector<int> place(L.n);
    for (std::size_t k = 0; k < L.n; ++k) place[static_cast<std::size_t>(factor->order[k])] = static_cast<int>(k);
    const Permuted A = permuted(lower, place);
    if (!Factorisation<Factor>(*factor, A).run()) return std::nullopt;
    return SupernodalCholesky(std::move(factor));
}

void SupernodalCholesky::solve_in_place(Eigen::VectorXd& b) const {
    const Factor& L = *factor_;
    Eigen::VectorXd x(b.size());
    for (Eigen::Index k = 0; k < x.size(); ++k) x(k) = b(L.order[static_cast<std::size_t>(k)]);
    Eigen::VectorXd part;
    for (std::size_t s = 0; s < L.count(); ++s) {
        const int width = L.width(s), below = L.height(s) - width;
        const int* row = L.rows.data() + L.first_row[s] + width;
        auto own = x.segment(L.first[s], width);
        L.block(s).topRows(width).triangularView<Eigen::Lower>().solveInPlace(own);
        part.noalias() = L.block(s).bottomRows(below) * own;
        for (int i = 0; i < below; ++i) x(row[i]) -= part(i);
    }
    for (std::size_t s = L.count(); s-- > 0;) {
        const int width = L.width(s), below = L.height(s) - width;
        const int* row = L.rows.data() + L.first_row[s] + width;
        part.resize(below);
        for (int i = 0; i < below; ++i) part(i) = x(row[i]);
        auto own = x.segment(L.first[s], width);
        own.noalias() -= L.block(s).bottomRows(below).transpose() * part;
        L.block(s).topRows(width).transpose().triangularView<Eigen::Upper>().solveInPlace(own);
    }
    for (Eigen::Index k = 0; k < x.size(); ++k) b(L.order[static_cast<std::size_t>(k)]) = x(k);
}

namespace {

// What several right-hand sides have in one row. More of them would leave the first-level caches to each other.
constexpr int together = 10;
using Together = Eigen::Array<double, together, 1>;

// One supernode at work on them.
struct Step {
    ConstBlock L;
    const int* rows;  // of those below its own
    Together* own;
    Together* all;

    int width() const { return static_cast<int>(L.cols()); }
    int below() const { return static_cast<int>(L.rows() - L.cols()); }

    bool is_zero() const {
        return std::all_of(own, own + width(), [](const Together& x) { return (x == 0).all(); });
    }

    void forward() const {
        for (int c = 0; c < width(); ++c) {
            own[c] /= L(c, c);
            for (int r = c + 1; r < width(); ++r) own[r] -= L(r, c) * own[c];
        }
        int c = 0;
        for (; c + 4 <= width(); c += 4) take<4>(c);
        for (; c < width(); ++c) take<1>(c);
    }

    void backward() const {
        int c = 0;
        for (; c + 2 <= width(); c += 2) give<2>(c);
        if (c < width()) give<1>(c);
        for (c = width(); c-- > 0;) {
            for (int r = c + 1; r < width(); ++r) own[c] -= L(r, c) * own[r];
            own[c] /= L(c, c);
        }
    }

private:
    // What `count` columns from c on take from the rows below.
    template <int count>
    void take(int c) const {
        const double* l = L.col(c).data() + width();
        for (int i = 0; i < below(); ++i) {
            Together sum = l[i] * own[c];
            for (int k = 1; k < count; ++k) sum += l[k * L.rows() + i] * own[c + k];
            all[rows[i]] -= sum;
        }
    }

    // What the rows below give to these columns.
    template <int count>
    void give(int c) const {
        const double* l = L.col(c).data() + width();
        std::array<Together, count> sums;
        sums.fill(Together::Zero());
        for (int i = 0; i < below(); ++i) {
            const Together& x = all[rows[i]];
            for (std::size_t k = 0; k < count; ++k) sums[k] += l[static_cast<Eigen::Index>(k) * L.rows() + i] * x;
        }
        for (std::size_t k = 0; k < count; ++k) own[c + static_cast<int>(k)] -= sums[k];
    }
};

}  // namespace

void SupernodalCholesky::solve_in_place(RowMatrix& B) const {
    const Factor& L = *factor_;
    std::vector<Together> x(static_cast<std::size_t>(B.rows()));
    const auto step = [&](std::size_t s) {
        return Step{L.block(s), L.rows.data() + L.first_row[s] + L.width(s), x.data() + L.first[s], x.data()};
    };
    for (Eigen::Index first = 0; first < B.cols(); first += together) {
        const Eigen::Index count = std::min<Eigen::Index>(together, B.cols() - first);
        for (std::size_t k = 0; k < x.size(); ++k) {
            x[k].setZero();
            for (Eigen::Index c = 0; c < count; ++c) x[k](c) = B(L.order[k], first + c);
        }
        // Sparse right-hand sides reach few supernodes.
        for (std::size_t s = 0; s < L.count(); ++s) {
            if (!step(s).is_zero()) step(s).forward();
        }
        for (std::size_t s = L.count(); s-- > 0;) step(s).backward();
        for (std::size_t k = 0; k < x.size(); ++k) {
            for (Eigen::Index c = 0; c < count; ++c) B(L.order[k], first + c) = x[k](c);
        }
    }
}

}  // namespace puppetwarp
