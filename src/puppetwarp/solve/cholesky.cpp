#include <puppetwarp/solve/cholesky.h>

#include <puppetwarp/solve/cholmod_factor.h>

#include <cassert>
#include <complex>
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

// Forward and backward substitution; T is double, or complex for two right-hand sides at once.
template <typename T>
void substitute(const cholmod_factor& L, Eigen::Matrix<T, Eigen::Dynamic, 1>& b) {
    const auto n = static_cast<int>(L.n);
    assert(b.size() == n);
    const int* start = static_cast<const int*>(L.p);
    const int* length = static_cast<const int*>(L.nz);
    const int* row = static_cast<const int*>(L.i);
    const double* value = static_cast<const double*>(L.x);
    const int* order = static_cast<const int*>(L.Perm);

    std::vector<T> y(static_cast<std::size_t>(n));
    T* const x = y.data();
    for (int j = 0; j < n; ++j) x[j] = b(order[j]);
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
        T even(0), odd(0);
        int k = first + 1;
        for (; k + 1 < end; k += 2) {
            even += value[k] * x[row[k]];
            odd += value[k + 1] * x[row[k + 1]];
        }
        if (k < end) even += value[k] * x[row[k]];
        x[j] = (x[j] - (even + odd)) / value[first];
    }
    for (int j = 0; j < n; ++j) b(order[j]) = x[j];
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
