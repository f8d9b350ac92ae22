#include <puppetwarp/deform/factored_hessian.h>

#include <puppetwarp/base/errors.h>

#include <algorithm>
#include <cassert>
#include <complex>
#include <type_traits>
#include <utility>

namespace puppetwarp {

namespace {

using Complex = std::complex<double>;

// Against null spaces that the handles leave, such as the rotation about a single pin: far below what any deformation
// costs, far above round-off.
constexpr double regularisation = 1e-7;

[[noreturn]] void throw_indefinite() {
    throw InvalidInput("mesh", "its triangles are too thin or too different in size to compute with",
                       "use a mesh with better triangles");
}

std::vector<int> numbered(const std::vector<bool>& free, std::vector<int>& vertices) {
    std::vector<int> slot(free.size(), -1);
    for (std::size_t v = 0; v < free.size(); ++v) {
        if (!free[v]) continue;
        slot[v] = static_cast<int>(vertices.size());
        vertices.push_back(static_cast<int>(v));
    }
    return slot;
}

template <typename Factor>
class OverFreeVertices : public FactoredHessian {
public:
    OverFreeVertices(std::vector<int> free, Factor factor, bool exact)
        : free_(std::move(free)), factor_(std::move(factor)), exact_(exact) {}

    Eigen::VectorXcd inverse_times(const Eigen::VectorXcd& q) const override {
        Eigen::VectorXcd b = gathered(q);
        factor_.solve_in_place(b);
        return scattered(b, q.size());
    }
    std::pair<Eigen::VectorXcd, Eigen::VectorXcd> inverse_times_both(const Eigen::VectorXcd& q) const override {
        Eigen::VectorXcd b = gathered(q), turned = Complex(0, 1) * b;
        if constexpr (std::is_same_v<Factor, PairedCholeskyFactor>) {
            factor_.solve_in_place(b, turned);
        } else {
            factor_.solve_in_place(b);  // a real matrix
            turned = Complex(0, 1) * b;
        }
        return {scattered(b, q.size()), scattered(turned, q.size())};
    }
    bool exact() const override { return exact_; }

private:
    Eigen::VectorXcd gathered(const Eigen::VectorXcd& q) const {
        Eigen::VectorXcd b(static_cast<Eigen::Index>(free_.size()));
        for (std::size_t i = 0; i < free_.size(); ++i) b(static_cast<Eigen::Index>(i)) = q(free_[i]);
        return b;
    }
    Eigen::VectorXcd scattered(const Eigen::VectorXcd& b, Eigen::Index vertices) const {
        Eigen::VectorXcd result = Eigen::VectorXcd::Zero(vertices);
        for (std::size_t i = 0; i < free_.size(); ++i) result(free_[i]) = b(static_cast<Eigen::Index>(i));
        return result;
    }

    std::vector<int> free_;
    Factor factor_;
    bool exact_;
};

}  // namespace

HessianFactory::HessianFactory(const Energy& energy, const std::vector<bool>& free, VertexSprings grounds,
                               VertexSprings springs)
    : energy_(energy), grounds_(std::move(grounds)), springs_(std::move(springs)), slot_(numbered(free, free_)) {
    if (free_.empty()) return;
    build_pattern();
    build_cell_map();
    pattern_.emplace(constant_);
}

void HessianFactory::build_pattern() {
    std::vector<Eigen::Triplet<double>> entries;
    const auto add_block = [&](int a, int b, double value) {
        const int i = slot_[static_cast<std::size_t>(a)];
        const int j = slot_[static_cast<std::size_t>(b)];
        if (i < j || j < 0) return;
        entries.emplace_back(2 * i, 2 * j, value);
        entries.emplace_back(2 * i + 1, 2 * j + 1, value);
        entries.emplace_back(2 * i + 1, 2 * j, 0.0);
        if (i > j) entries.emplace_back(2 * i, 2 * j + 1, 0.0);
    };
    for (int c = 0; c < energy_.cells(); ++c) {
        for (const int a : energy_.vertices(c)) {
            for (const int b : energy_.vertices(c)) add_block(a, b, 0);
        }
    }
    const SparseMatrix& constant = energy_.constant_hessian();
    for (int column = 0; column < constant.outerSize(); ++column) {
        for (SparseMatrix::InnerIterator it(constant, column); it; ++it) {
            add_block(static_cast<int>(it.row()), column, (1 + regularisation) * it.value());
        }
    }
    for (const VertexSprings* springs : {&grounds_, &springs_}) {
        for (const int v : springs->vertices) add_block(v, v, springs->stiffness);
    }
    const auto size = 2 * static_cast<Eigen::Index>(free_.size());
    constant_.resize(size, size);
    constant_.setFromTriplets(entries.begin(), entries.end());
}

int HessianFactory::find(int row, int column) const {
    if (row < column) std::swap(row, column);
    const int* begin = constant_.innerIndexPtr() + constant_.outerIndexPtr()[column];
    const int* end = constant_.innerIndexPtr() + constant_.outerIndexPtr()[column + 1];
    return static_cast<int>(std::lower_bound(begin, end, row) - constant_.innerIndexPtr());
}

void HessianFactory::build_cell_map() {
    std::vector<int> unknown;
    for (int c = 0; c < energy_.cells(); ++c) {
        unknown.clear();
        for (const int v : energy_.vertices(c)) {
            const int i = slot_[static_cast<std::size_t>(v)];
            unknown.push_back(i < 0 ? -1 : 2 * i);
            unknown.push_back(i < 0 ? -1 : 2 * i + 1);
        }
        for (std::size_t a = 0; a < unknown.size(); ++a) {
            for (std::size_t b = 0; b <= a; ++b) {
                cell_map_.push_back(unknown[a] < 0 || unknown[b] < 0 ? -1 : find(unknown[a], unknown[b]));
            }
        }
    }
}

void HessianFactory::fill(Eigen::SparseMatrix<double>& H, const Eigen::VectorXcd& x, HessianKind kind) const {
    double* values = H.valuePtr();
    std::copy(constant_.valuePtr(), constant_.valuePtr() + constant_.nonZeros(), values);
    std::vector<double> lower;
    const int* place = cell_map_.data();
    for (int c = 0; c < energy_.cells(); ++c) {
        const std::size_t k = energy_.vertices(c).size();
        lower.resize(k * (2 * k + 1));
        energy_.cell_hessian(c, x, kind, lower.data());
        for (const double value : lower) {
            if (*place >= 0) values[*place] += value;
            ++place;
        }
    }
}

std::shared_ptr<const FactoredHessian> HessianFactory::factorise(const Eigen::VectorXcd& x) const {
    assert(pattern_);
    Eigen::SparseMatrix<double> H = constant_;
    for (const HessianKind kind : {HessianKind::exact, HessianKind::clamped}) {
        fill(H, x, kind);
        if (auto factor = pattern_->factorise(H)) {
            return std::make_shared<OverFreeVertices<PairedCholeskyFactor>>(free_, std::move(*factor),
                                                                            kind == HessianKind::exact);
        }
    }
    throw_indefinite();
}

std::shared_ptr<const FactoredHessian> factor_quadratic(const SparseMatrix& matrix, const std::vector<bool>& free,
                                                        const VertexSprings& grounds) {
    std::vector<int> vertices;
    const std::vector<int> slot = numbered(free, vertices);
    std::vector<Eigen::Triplet<double>> entries;
    for (int column = 0; column < matrix.outerSize(); ++column) {
        const int j = slot[static_cast<std::size_t>(column)];
        for (SparseMatrix::InnerIterator it(matrix, column); it; ++it) {
            const int i = slot[static_cast<std::size_t>(it.row())];
            if (j >= 0 && i >= j) entries.emplace_back(i, j, (1 + regularisation) * it.value());
        }
    }
    for (const int v : grounds.vertices) {
        const int i = slot[static_cast<std::size_t>(v)];
        if (i >= 0) entries.emplace_back(i, i, grounds.stiffness);
    }
    const auto size = static_cast<Eigen::Index>(vertices.size());
    Eigen::SparseMatrix<double> lower(size, size);
    lower.setFromTriplets(entries.begin(), entries.end());
    auto factor = CholeskyPattern(lower).factorise(lower);
    if (!factor) throw_indefinite();
    return std::make_shared<OverFreeVertices<CholeskyFactor>>(std::move(vertices), std::move(*factor), false);
}

}  // namespace puppetwarp
