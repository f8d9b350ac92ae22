#include <puppetwarp/deform/mean_system.h>

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace puppetwarp {

namespace {

constexpr double rank_threshold = 1e-13;
// Modes that move means by less than this share of what others do move none.
constexpr double idle = 1e-7;

}  // namespace

MeanSystem::MeanSystem(const Eigen::MatrixXcd& means) : scale_(Eigen::VectorXd::Ones(means.cols())) {
    const Eigen::Index m = means.rows(), size = means.cols();
    Eigen::MatrixXcd saddle = Eigen::MatrixXcd::Zero(size, size);
    saddle.topRows(m) = means;
    saddle.bottomLeftCorner(size - m, m) = means.rightCols(size - m).adjoint();
    // To similar size: answers grow with the mesh's resolution, modes do not.
    for (Eigen::Index i = 0; i < size; ++i) {
        const double length =
            i < m ? std::sqrt(std::max(means(i, i).real(), 0.0)) : means.col(i).cwiseProduct(scale_.head(m)).norm();
        if (length > 0) scale_(i) = 1 / length;
    }
    if (size == 0) return;
    solver_.setThreshold(rank_threshold);
    solver_.compute(scale_.asDiagonal() * saddle * scale_.asDiagonal());
}

Eigen::MatrixXcd MeanSystem::inverse() const {
    if (scale_.size() == 0) return Eigen::MatrixXcd(0, 0);
    return scale_.asDiagonal() * solver_.pseudoInverse() * scale_.asDiagonal();
}

Eigen::MatrixXcd null_space(const Eigen::MatrixXcd& columns) {
    if (columns.cols() == 0) return Eigen::MatrixXcd(0, 0);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXcd> spectrum(columns.adjoint() * columns);
    const double largest = spectrum.eigenvalues().maxCoeff();
    Eigen::Index count = 0;
    while (count < columns.cols() && spectrum.eigenvalues()(count) <= idle * idle * largest) ++count;
    return spectrum.eigenvectors().leftCols(count);
}

}  // namespace puppetwarp
