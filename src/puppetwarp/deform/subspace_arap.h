#pragma once
// Private header.

#include <puppetwarp/deform/linear_blend.h>
#include <puppetwarp/mesh/operators.h>

#include <complex>
#include <optional>
#include <vector>

namespace puppetwarp {

//! The energy of `arap` by triangles over the positions that linear blend skinning can make, in numbers that do not
//! grow with the mesh (Jacobson et al. 2012). Column j displaces z by e + a (z - c_j) + b conj(z - c_j): 3 complex
//! unknowns d = (e, a, b) a column. Groups of triangles with like weights share a rotation r_c:
//!   E(d) = sum over triangles of 2 area (|1 + f_z - r_c|^2 + |f_zbar|^2)
//!        = d^H K d + sum_c 4 Re(conj(1 - r_c) S_c d) + 2 area_c |1 - r_c|^2,
//! least for the rotations r_c in the direction of area_c + S_c d. Areas are times the stiffness.
struct SubspaceArap {
    Eigen::MatrixXcd K;    //!< 3 #columns square, Hermitian
    Eigen::MatrixXcd S;    //!< #groups x 3 #columns: area-weighted sums of f_z
    Eigen::VectorXd area;  //!< #groups
    Eigen::SparseMatrix<std::complex<double>, Eigen::RowMajor> sums;  //!< #groups x #V: the same of any positions

    //! \param stiffness  #F, or empty for 1.   \param W  #V x #columns.   \param centres  c_j, #columns.
    SubspaceArap(const TriangleMesh& mesh, const Eigen::VectorXd& stiffness, const WeightRows& W,
                 const Eigen::VectorXcd& centres);
};

//! One entry of d that may change, times a complex factor: one real unknown.
struct SubspaceUnknown {
    Eigen::Index entry;  //!< of d
    //! Direction in which the unknown moves the entry. None: along the circle about -1, which turns and does not scale.
    std::optional<std::complex<double>> factor;
};

struct SubspaceMinimum {
    Eigen::VectorXcd d;
    std::vector<double> energies;  //!< from the start on, never rising
    int iterations = 0;
    bool converged = false;
};

//! Newton's method on E with the rotations eliminated; where its Hessian is not positive definite, the step of the
//! local/global alternation, which takes the rotations for constants. Steps are shortened until E does not rise.
//! \param start      3 #columns; entries without unknowns stay.
//! \param rotations  #groups units to begin with, or empty for those of `start`: the first step is then global.
//! \param tolerance  converged when the step would gain less than this share of E.
SubspaceMinimum minimise(const SubspaceArap& arap, const std::vector<SubspaceUnknown>& unknowns,
                         const Eigen::VectorXcd& start, const Eigen::VectorXcd& rotations, double tolerance,
                         int max_iterations);

}  // namespace puppetwarp
