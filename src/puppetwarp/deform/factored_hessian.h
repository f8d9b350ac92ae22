#pragma once
// Private header.

#include <puppetwarp/deform/energy.h>
#include <puppetwarp/solve/cholesky.h>
#include <puppetwarp/solve/paired_cholesky.h>

#include <memory>
#include <utility>
#include <vector>

namespace puppetwarp {

//! Weights on single vertices, added to a Hessian's diagonal: `stiffness` |x_vertex|^2 / 2 each.
struct VertexSprings {
    std::vector<int> vertices;
    double stiffness = 0;
};

//! The inverse of an energy's second derivative, or of something like it, over the vertices that are free to move.
//! Immutable, safe to share between threads.
class FactoredHessian {
public:
    FactoredHessian() = default;
    FactoredHessian(const FactoredHessian&) = delete;
    FactoredHessian& operator=(const FactoredHessian&) = delete;
    virtual ~FactoredHessian() = default;

    //! The inverse times q (#V), 0 at the vertices that are not free.
    virtual Eigen::VectorXcd inverse_times(const Eigen::VectorXcd& q) const = 0;
    //! Whether it is of the true second derivative at some x.
    virtual bool exact() const = 0;
    //! The inverse times q and times i q, at about the price of one.
    virtual std::pair<Eigen::VectorXcd, Eigen::VectorXcd> inverse_times_both(const Eigen::VectorXcd& q) const = 0;
};

//! The second derivatives of one energy at any x: pattern, order of elimination and factors. Immutable, safe to share
//! between threads.
class HessianFactory {
public:
    //! \param energy   kept by reference.
    //! \param free     #V: whether a vertex may move.
    //! \param grounds  springs that make the Hessian definite where only the handles would.
    //! \param springs  those of the problem itself.
    HessianFactory(const Energy& energy, const std::vector<bool>& free, VertexSprings grounds, VertexSprings springs);

    //! A factor of the Hessian at x: of the true one where that is positive definite, else of the nearest that is.
    //! \throw InvalidInput  the mesh's triangles are too bad for any.
    std::shared_ptr<const FactoredHessian> factorise(const Eigen::VectorXcd& x) const;

private:
    void build_pattern();
    void build_cell_map();
    int find(int row, int column) const;
    void fill(Eigen::SparseMatrix<double>& H, const Eigen::VectorXcd& x, HessianKind kind) const;

    const Energy& energy_;
    VertexSprings grounds_;
    VertexSprings springs_;
    std::vector<int> free_;                 // vertices
    std::vector<int> slot_;                 // of each vertex among free_, or -1
    Eigen::SparseMatrix<double> constant_;  // lower triangle: pattern of all, values of what does not change
    std::vector<int> cell_map_;             // where each cell's numbers go among the values; -1: nowhere
    std::optional<PairedCholeskyPattern> pattern_;
};

//! A factor of a constant real matrix that acts on both parts of a position alike: half the unknowns, no refreshing.
//! \param matrix  #V x #V, symmetric, positive definite over the free vertices once the grounds are added.
//! \throw InvalidInput  it is not.
std::shared_ptr<const FactoredHessian> factor_quadratic(const SparseMatrix& matrix, const std::vector<bool>& free,
                                                        const VertexSprings& grounds);

}  // namespace puppetwarp
