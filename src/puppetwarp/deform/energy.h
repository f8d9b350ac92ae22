#pragma once
// Private header.

#include <puppetwarp/mesh/operators.h>

#include <limits>
#include <span>

namespace puppetwarp {

//! How true a second derivative is to its energy: the true one, or one that is positive semi-definite.
enum class HessianKind { exact, clamped };

//! An energy of the vertices' positions, these as complex numbers x (#V): 0 at rest, the same under rigid motions.
//! Its Hessian over (Re x, Im x) is a constant real matrix that acts on both parts alike, plus small dense matrices
//! over the vertices of cells. Immutable.
class Energy {
public:
    Energy() = default;
    Energy(const Energy&) = delete;
    Energy& operator=(const Energy&) = delete;
    virtual ~Energy() = default;

    //! px^2; infinite where the energy is not defined.
    virtual double value(const Eigen::VectorXcd& x) const = 0;
    //! \param g  #V; dE/dRe x + i dE/dIm x, unspecified where the energy is infinite.   \return the value.
    virtual double gradient(const Eigen::VectorXcd& x, Eigen::VectorXcd& g) const = 0;
    //! The least t > 0 at which the energy of x + t step stops to be defined.
    virtual double largest_step(const Eigen::VectorXcd& /*x*/, const Eigen::VectorXcd& /*step*/) const {
        return std::numeric_limits<double>::infinity();
    }

    //! The constant part of the Hessian, #V x #V.
    virtual const SparseMatrix& constant_hessian() const = 0;
    virtual int cells() const = 0;
    //! Vertices of a cell, all different.
    virtual std::span<const int> vertices(int cell) const = 0;
    //! \param lower  lower triangle, row by row, of the cell's matrix over (Re, Im) of its vertices; k vertices fill
    //!               k (2 k + 1) numbers.
    virtual void cell_hessian(int cell, const Eigen::VectorXcd& x, HessianKind kind, double* lower) const = 0;
};

}  // namespace puppetwarp
