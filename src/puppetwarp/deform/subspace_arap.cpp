#include <puppetwarp/deform/subspace_arap.h>

#include <puppetwarp/deform/element_energy.h>
#include <puppetwarp/deform/weight_clusters.h>

namespace puppetwarp {

namespace {

using Complex = std::complex<double>;
using ComplexSparse = Eigen::SparseMatrix<Complex>;

// Rotations are shared by groups: this many a column. Four times as many lower the energy of what comes out by about a
// hundredth.
constexpr int groups_per_column = 5;

// #V x 3 #columns: positions, less the rest places, are this matrix times d.
ComplexSparse skinning_basis(const WeightRows& W, const Eigen::VectorXcd& z, const Eigen::VectorXcd& centres) {
    std::vector<Eigen::Triplet<Complex>> entries;
    entries.reserve(3 * static_cast<std::size_t>(W.nonZeros()));
    for (Eigen::Index v = 0; v < W.rows(); ++v) {
        for (WeightRows::InnerIterator w(W, v); w; ++w) {
            const Complex arm = z(v) - centres(w.col());
            entries.emplace_back(v, 3 * w.col(), w.value());
            entries.emplace_back(v, 3 * w.col() + 1, w.value() * arm);
            entries.emplace_back(v, 3 * w.col() + 2, w.value() * std::conj(arm));
        }
    }
    ComplexSparse basis(W.rows(), 3 * W.cols());
    basis.setFromTriplets(entries.begin(), entries.end());
    return basis;
}

Eigen::VectorXi element_groups(const std::vector<Element>& elements, const WeightRows& W) {
    const Eigen::MatrixXd dense(W);
    const auto count = static_cast<Eigen::Index>(elements.size());
    Eigen::MatrixXd means(count, W.cols());
    Eigen::VectorXd areas(count);
    for (Eigen::Index t = 0; t < count; ++t) {
        const Element& e = elements[static_cast<std::size_t>(t)];
        means.row(t) = (dense.row(e.v[0]) + dense.row(e.v[1]) + dense.row(e.v[2])) / 3;
        areas(t) = e.weight;
    }
    return weight_clusters(means, areas, groups_per_column * static_cast<int>(W.cols()));
}

}  // namespace

SubspaceArap::SubspaceArap(const TriangleMesh& mesh, const Eigen::VectorXd& stiffness, const WeightRows& W,
                           const Eigen::VectorXcd& centres) {
    const std::vector<Element> elements = elements_of(mesh, stiffness);
    const Eigen::VectorXi group = element_groups(elements, W);
    area = Eigen::VectorXd::Zero(group.maxCoeff() + 1);
    std::vector<Eigen::Triplet<Complex>> entries;
    entries.reserve(3 * elements.size());
    for (std::size_t t = 0; t < elements.size(); ++t) {
        const Element& e = elements[t];
        const int c = group(static_cast<Eigen::Index>(t));
        area(c) += e.weight;
        entries.emplace_back(c, e.v[0], -e.weight * (e.c1 + e.c2));
        entries.emplace_back(c, e.v[1], e.weight * e.c1);
        entries.emplace_back(c, e.v[2], e.weight * e.c2);
    }
    sums.resize(area.size(), mesh.V.rows());
    sums.setFromTriplets(entries.begin(), entries.end());

    const Eigen::VectorXcd z = mesh.V.col(0) + Complex(0, 1) * mesh.V.col(1);
    const ComplexSparse basis = skinning_basis(W, z, centres);
    const ComplexSparse L = cotangent_stiffness(mesh, stiffness).cast<Complex>();
    K = ComplexSparse(basis.adjoint() * ComplexSparse(L * basis));
    S = ComplexSparse(ComplexSparse(sums) * basis);
}

}  // namespace puppetwarp
