#include <puppetwarp/solve/block_ldlt.h>

#include <Eigen/LU>
#include <Eigen/OrderingMethods>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace puppetwarp {

namespace detail {

class BlockFactor {
public:
    BlockFactor() = default;
    BlockFactor(const BlockFactor&) = delete;
    BlockFactor& operator=(const BlockFactor&) = delete;
    virtual ~BlockFactor() = default;
    virtual Eigen::MatrixXd solve(const Eigen::MatrixXd& B) const = 0;
};

}  // namespace detail

namespace {

// Where the blocks of P A P^T are: of each row those left of the diagonal, and which entry of A each is.
struct PermutedRows {
    struct Entry {
        int column;
        int source;       // index among A's entries
        bool transposed;  // A stores the block of (column, row)
    };
    std::vector<int> order;  // row of A that comes k-th
    std::vector<std::vector<Entry>> left;
    std::vector<int> diagonal;  // index among A's entries
};

PermutedRows permuted_rows(const Eigen::SparseMatrix<double>& pattern) {
    const auto n = static_cast<int>(pattern.rows());
    Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> elimination;
    Eigen::AMDOrdering<int>()(pattern.selfadjointView<Eigen::Lower>(), elimination);
    PermutedRows rows;
    rows.order.assign(elimination.indices().data(), elimination.indices().data() + n);
    std::vector<int> place(static_cast<std::size_t>(n));
    for (int k = 0; k < n; ++k) place[static_cast<std::size_t>(rows.order[static_cast<std::size_t>(k)])] = k;
    rows.left.resize(static_cast<std::size_t>(n));
    rows.diagonal.assign(static_cast<std::size_t>(n), -1);
    int source = 0;
    for (int column = 0; column < n; ++column) {
        for (Eigen::SparseMatrix<double>::InnerIterator it(pattern, column); it; ++it, ++source) {
            assert(it.row() >= column);
            const int r = place[static_cast<std::size_t>(it.row())];
            const int c = place[static_cast<std::size_t>(column)];
            if (r == c) {
                rows.diagonal[static_cast<std::size_t>(r)] = source;
            } else {
                rows.left[static_cast<std::size_t>(std::max(r, c))].push_back({std::min(r, c), source, r < c});
            }
        }
    }
    return rows;
}

template <int K>
class SizedFactor final : public detail::BlockFactor {
public:
    using Block = Eigen::Matrix<double, K, K>;

    // Up-looking: row k of L solves L(0:k, 0:k) D y = A(0:k, k).
    bool compute(const BlockMatrix& A) {
        PermutedRows rows = permuted_rows(A.pattern);
        const std::size_t n = rows.order.size();
        order_ = std::move(rows.order);
        inverse_D_.resize(n);
        std::vector<std::vector<Entry>> columns(n);  // of L below the diagonal
        std::vector<int> parent(n, -1), mark(n, -1), reach;
        std::vector<Block> y(n, Block::Zero());
        const auto block = [&](int source) {
            return Block(Eigen::Map<const Block>(&A.blocks[static_cast<std::size_t>(source) * K * K]));
        };
        for (std::size_t k = 0; k < n; ++k) {
            reach.clear();
            mark[k] = static_cast<int>(k);
            for (const auto& entry : rows.left[k]) {
                // Block (column, k) of the upper triangle.
                const Block a = block(entry.source);
                y[static_cast<std::size_t>(entry.column)] = entry.transposed ? a : a.transpose();
                add_to_reach(entry.column, static_cast<int>(k), parent, mark, reach);
            }
            // Elimination goes from low columns to high: each updates higher ones only.
            std::sort(reach.begin(), reach.end());
            Block D = block(rows.diagonal[k]);
            for (const int j : reach) {
                auto& column = columns[static_cast<std::size_t>(j)];
                const Block yj = std::exchange(y[static_cast<std::size_t>(j)], Block::Zero());
                for (const auto& [row, l] : column) y[static_cast<std::size_t>(row)].noalias() -= l * yj;
                const Block l = (inverse_D_[static_cast<std::size_t>(j)] * yj).transpose();
                D.noalias() -= l * yj;
                column.emplace_back(static_cast<int>(k), l);
            }
            if (!D.allFinite()) return false;
            inverse_D_[k] = inverse_of(D);
            if (!inverse_D_[k].allFinite()) return false;
        }
        pack(columns);
        return true;
    }

    Eigen::MatrixXd solve(const Eigen::MatrixXd& B) const override {
        Eigen::MatrixXd X(B.rows(), B.cols());
        // Four right-hand sides go through the factor together: the time is in fetching it.
        for (Eigen::Index c = 0; c < B.cols(); c += width) substitute(B, X, c, std::min(B.cols() - c, width));
        return X;
    }

private:
    static constexpr Eigen::Index width = 4;

    struct Entry {
        int row;
        Block l;
        Entry(int row_, const Block& l_) : row(row_), l(l_) {}
    };

    // The entries of a block far from the first vertices span many orders of magnitude, rising from component to
    // component: a geometric scale levels them.
    static Block inverse_of(const Block& D) {
        Eigen::Matrix<double, K, 1> scale = Eigen::Matrix<double, K, 1>::Ones();
        if constexpr (K > 1) {
            const double rise = std::pow(std::abs(D(K - 1, K - 1) / D(0, K - 1)), 1.0 / (K - 1));
            for (int i = 0; rise > 0 && std::isfinite(rise) && i < K; ++i) scale(i) = std::pow(rise, 0.5 * (K - 1) - i);
        }
        const Block level = scale.asDiagonal() * D * scale.asDiagonal();
        return scale.asDiagonal() * Eigen::PartialPivLU<Block>(level).inverse() * scale.asDiagonal();
    }

    // The columns that a first non-zero at `column` fills in row k: its way up the elimination tree.
    static void add_to_reach(int column, int k, std::vector<int>& parent, std::vector<int>& mark,
                             std::vector<int>& reach) {
        for (int j = column; mark[static_cast<std::size_t>(j)] != k;) {
            mark[static_cast<std::size_t>(j)] = k;
            reach.push_back(j);
            if (parent[static_cast<std::size_t>(j)] < 0) parent[static_cast<std::size_t>(j)] = k;
            j = parent[static_cast<std::size_t>(j)];
        }
    }

    // All columns behind each other, as substitution goes through them.
    void pack(const std::vector<std::vector<Entry>>& columns) {
        start_.assign(1, 0);
        for (const auto& column : columns) start_.push_back(start_.back() + column.size());
        rows_.reserve(start_.back());
        blocks_.reserve(start_.back());
        for (const auto& column : columns) {
            for (const Entry& entry : column) {
                rows_.push_back(entry.row);
                blocks_.push_back(entry.l);
            }
        }
    }

    void substitute(const Eigen::MatrixXd& B, Eigen::MatrixXd& X, Eigen::Index first, Eigen::Index count) const {
        using Part = Eigen::Matrix<double, K, width>;
        const std::size_t n = order_.size();
        std::vector<Part> x(n, Part::Zero());
        const auto place = [&](std::size_t k) { return static_cast<Eigen::Index>(order_[k]) * K; };
        for (std::size_t k = 0; k < n; ++k) x[k].leftCols(count) = B.block(place(k), first, K, count);
        for (std::size_t j = 0; j < n; ++j) {
            const Part xj = x[j];
            for (std::size_t p = start_[j]; p < start_[j + 1]; ++p) {
                x[static_cast<std::size_t>(rows_[p])].noalias() -= blocks_[p] * xj;
            }
        }
        for (std::size_t j = n; j-- > 0;) {
            Part sum = inverse_D_[j] * x[j];
            for (std::size_t p = start_[j]; p < start_[j + 1]; ++p) {
                sum.noalias() -= blocks_[p].transpose() * x[static_cast<std::size_t>(rows_[p])];
            }
            x[j] = sum;
        }
        for (std::size_t k = 0; k < n; ++k) X.block(place(k), first, K, count) = x[k].leftCols(count);
    }

    std::vector<int> order_;
    std::vector<Block> inverse_D_;
    // L below the diagonal, column by column.
    std::vector<std::size_t> start_;
    std::vector<int> rows_;
    std::vector<Block> blocks_;
};

template <int K>
std::unique_ptr<const detail::BlockFactor> factor_of_size(const BlockMatrix& A) {
    auto factor = std::make_unique<SizedFactor<K>>();
    if (!factor->compute(A)) return nullptr;
    return factor;
}

}  // namespace

BlockLdlt::BlockLdlt(std::unique_ptr<const detail::BlockFactor> factor) : factor_(std::move(factor)) {}
BlockLdlt::BlockLdlt(BlockLdlt&&) noexcept = default;
BlockLdlt& BlockLdlt::operator=(BlockLdlt&&) noexcept = default;
BlockLdlt::~BlockLdlt() = default;

std::optional<BlockLdlt> BlockLdlt::factorise(const BlockMatrix& A) {
    assert(A.size >= 1 && A.size <= 4 && A.pattern.isCompressed());
    assert(A.blocks.size() == static_cast<std::size_t>(A.pattern.nonZeros() * A.size * A.size));
    std::unique_ptr<const detail::BlockFactor> factor;
    switch (A.size) {
        case 1: factor = factor_of_size<1>(A); break;
        case 2: factor = factor_of_size<2>(A); break;
        case 3: factor = factor_of_size<3>(A); break;
        default: factor = factor_of_size<4>(A); break;
    }
    if (!factor) return std::nullopt;
    return BlockLdlt(std::move(factor));
}

Eigen::MatrixXd BlockLdlt::solve(const Eigen::MatrixXd& B) const {
    return factor_->solve(B);
}

}  // namespace puppetwarp
