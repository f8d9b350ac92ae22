#include <puppetwarp/solve/grounded_inverse.h>

#include <puppetwarp/base/errors.h>

#include <cassert>

namespace puppetwarp {

GroundedInverse::GroundedInverse(const Eigen::SparseMatrix<double>& L, const Eigen::VectorXi& component) {
    assert(L.rows() == component.size());
    const auto n = static_cast<int>(L.rows());
    std::vector<int> slot(static_cast<std::size_t>(n), -1);
    int components = 0;
    for (int v = 0; v < n; ++v) {
        if (component(v) == components) {
            ++components;
            continue;
        }
        slot[static_cast<std::size_t>(v)] = static_cast<int>(free_.size());
        free_.push_back(v);
    }
    if (free_.empty()) return;

    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(static_cast<std::size_t>(L.nonZeros()));
    for (int column = 0; column < n; ++column) {
        for (Eigen::SparseMatrix<double>::InnerIterator it(L, column); it; ++it) {
            const int r = slot[static_cast<std::size_t>(it.row())];
            const int c = slot[static_cast<std::size_t>(column)];
            if (c >= 0 && r >= c) entries.emplace_back(r, c, it.value());
        }
    }
    const auto size = static_cast<Eigen::Index>(free_.size());
    Eigen::SparseMatrix<double> lower(size, size);
    lower.setFromTriplets(entries.begin(), entries.end());
    factor_ = CholeskyPattern(lower).factorise(lower);
    if (!factor_) {
        throw InvalidInput("mesh", "its triangles are too thin or too different in size to compute with",
                           "use a mesh with better triangles");
    }
}

Eigen::VectorXcd GroundedInverse::operator*(const Eigen::VectorXcd& r) const {
    Eigen::VectorXcd result = Eigen::VectorXcd::Zero(r.size());
    if (free_.empty()) return result;
    Eigen::VectorXcd b = r(free_);
    factor_->solve_in_place(b);
    result(free_) = b;
    return result;
}

Eigen::MatrixXd GroundedInverse::operator*(const Eigen::MatrixXd& R) const {
    Eigen::MatrixXd result = Eigen::MatrixXd::Zero(R.rows(), R.cols());
    if (free_.empty()) return result;
    Eigen::MatrixXd B = R(free_, Eigen::all);
    factor_->solve_in_place(B);
    result(free_, Eigen::all) = B;
    return result;
}

}  // namespace puppetwarp
