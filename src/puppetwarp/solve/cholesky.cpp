#include <puppetwarp/solve/cholesky.h>

#include <puppetwarp/solve/cholmod_factor.h>

#include <algorithm>
#include <cassert>
#include <complex>
#include <type_traits>
#include <utility>
#include <vector>

namespace puppetwarp {

namespace detail {

cholmod_sparse view_of(const Eigen::SparseMatrix<double>& A) {
    assert(A.isCompressed() && A.rows() == A.cols());
    cholmod_sparse view{};
    view.nrow = static_cast<std::size_t>(A.rows());
    view.ncol = static_cast<std::size_t>(A.cols());
    view.nzmax = static_cast<std::size_t>(A.nonZeros());
    view.p = const_cast<int*>(A.outerIndexPtr());
    view.i = const_cast<int*>(A.innerIndexPtr());
    view.x = const_cast<double*>(A.valuePtr());
    view.stype = -1;
    view.itype = CHOLMOD_INT;
    view.xtype = CHOLMOD_REAL;
    view.dtype = CHOLMOD_DOUBLE;
    view.sorted = 1;
    view.packed = 1;
    return view;
}

}  // namespace detail

namespace {

template <typename T>
T zero() {
    if constexpr (std::is_same_v<T, Eigen::Array4d>) {
        return Eigen::Array4d::Zero();
    } else {
        return T(0);
    }
}

// Forward and backward substitution; T is double, or holds several right-hand sides. `read(row)` gives, and `write(row,
// value)` takes them.
template <typename T, typename Read, typename Write>
void substitute(const cholmod_factor& L, const Read& read, const Write& write) {
    const auto n = static_cast<int>(L.n);
    const int* start = static_cast<const int*>(L.p);
    const int* length = static_cast<const int*>(L.nz);
    const int* row = static_cast<const int*>(L.i);
    const double* value = static_cast<const double*>(L.x);
    const int* order = static_cast<const int*>(L.Perm);

    std::vector<T> y(static_cast<std::size_t>(n));
    T* const x = y.data();
    for (int j = 0; j < n; ++j) x[j] = read(order[j]);
    for (int j = 0; j < n; ++j) {
        const int first = start[j];
        const int end = first + length[j];
        const T xj = x[j] / value[first];
        x[j] = xj;
        for (int k = first + 1; k < end; ++k) x[row[k]] -= value[k] * xj;
    }
    for (int j = n - 1; j >= 0; --j) {
        const int first = start[j];
        const int end = first + length[j];
        // Two sums, so that one addition need not wait for the one before.
        T even = zero<T>(), odd = zero<T>();
        int k = first + 1;
        for (; k + 1 < end; k += 2) {
            even += value[k] * x[row[k]];
            odd += value[k + 1] * x[row[k + 1]];
        }
        if (k < end) even += value[k] * x[row[k]];
        x[j] = (x[j] - (even + odd)) / value[first];
    }
    for (int j = 0; j < n; ++j) write(order[j], x[j]);
}

template <typename T>
void substitute(const cholmod_factor& L, Eigen::Matrix<T, Eigen::Dynamic, 1>& b) {
    assert(b.size() == static_cast<Eigen::Index>(L.n));
    substitute<T>(
        L, [&](int row) { return b(row); }, [&](int row, const T& value) { b(row) = value; });
}

// Columns first, first + 1, ... of B, at most four.
void substitute_four(const cholmod_factor& L, Eigen::MatrixXd& B, Eigen::Index first) {
    using Four = Eigen::Array4d;
    const Eigen::Index count = std::min<Eigen::Index>(4, B.cols() - first);
    const auto read = [&](int row) {
        Four four = zero<Four>();
        for (Eigen::Index c = 0; c < count; ++c) four(c) = B(row, first + c);
        return four;
    };
    const auto write = [&](int row, const Four& four) {
        for (Eigen::Index c = 0; c < count; ++c) B(row, first + c) = four(c);
    };
    substitute<Four>(L, read, write);
}

}  // namespace

CholeskyFactor::CholeskyFactor(std::unique_ptr<detail::CholmodFactor> factor) : factor_(std::move(factor)) {}
CholeskyFactor::CholeskyFactor(CholeskyFactor&&) noexcept = default;
CholeskyFactor& CholeskyFactor::operator=(CholeskyFactor&&) noexcept = default;
CholeskyFactor::~CholeskyFactor() = default;

int CholeskyFactor::size() const {
    return static_cast<int>(factor_->factor->n);
}

void CholeskyFactor::solve_in_place(Eigen::VectorXd& b) const {
    substitute(*factor_->factor, b);
}

void CholeskyFactor::solve_in_place(Eigen::VectorXcd& b) const {
    substitute(*factor_->factor, b);
}

void CholeskyFactor::solve_in_place(Eigen::MatrixXd& B) const {
    assert(B.rows() == size());
    const auto pair = [](Eigen::MatrixXd& M, Eigen::Index c) {
        return [&M, c](int row) { return std::complex<double>(M(row, c), M(row, c + 1)); };
    };
    Eigen::Index c = 0;
    for (; B.cols() - c >= 3; c += 4) substitute_four(*factor_->factor, B, c);
    if (B.cols() - c == 2) {
        substitute<std::complex<double>>(*factor_->factor, pair(B, c), [&](int row, const std::complex<double>& value) {
            B(row, c) = value.real();
            B(row, c + 1) = value.imag();
        });
    } else if (B.cols() - c == 1) {
        substitute<double>(
            *factor_->factor, [&](int row) { return B(row, c); }, [&](int row, double value) { B(row, c) = value; });
    }
}

CholeskyPattern::CholeskyPattern(const Eigen::SparseMatrix<double>& lower)
    : symbolic_(std::make_unique<detail::CholmodFactor>()) {
    cholmod_sparse view = detail::view_of(lower);
    symbolic_->factor = cholmod_analyze(&view, &symbolic_->common);
    symbolic_->require_success();
}

CholeskyPattern::CholeskyPattern(CholeskyPattern&&) noexcept = default;
CholeskyPattern& CholeskyPattern::operator=(CholeskyPattern&&) noexcept = default;
CholeskyPattern::~CholeskyPattern() = default;

std::optional<CholeskyFactor> CholeskyPattern::factorise(const Eigen::SparseMatrix<double>& lower) const {
    auto numeric = std::make_unique<detail::CholmodFactor>();
    numeric->factor = cholmod_copy_factor(symbolic_->factor, &numeric->common);
    numeric->require_success();
    cholmod_sparse view = detail::view_of(lower);
    cholmod_factorize(&view, numeric->factor, &numeric->common);
    numeric->require_success();
    if (numeric->factor->minor < numeric->factor->n) return std::nullopt;
    return CholeskyFactor(std::move(numeric));
}

}  // namespace puppetwarp
