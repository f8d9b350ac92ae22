#pragma once
// Private header: what all families that are solved on a mesh share.

#include <puppetwarp/mesh/operators.h>
#include <puppetwarp/weights/weights.h>

#include <string>
#include <vector>

namespace puppetwarp {

//! Where weights are given.
struct WeightConditions {
    std::vector<WeightColumn> columns;
    std::vector<int> vertices;  //!< ascending, of all that is given
    Eigen::MatrixXd values;     //!< #vertices x #columns; rows at least 0, sum 1
    std::vector<std::string> warnings;
};

//! One minimisation over a mesh.
struct WeightProblem {
    TriangleMesh mesh;
    Rig rig;
    Eigen::VectorXd stiffness;  //!< #F factors, `triangle_stiffness`, or empty
    WeightConditions conditions;

    //! \throw InvalidInput  see `compute_weights`.
    //! \pre require_sound(mesh), require_sound(rig); the edges of cages are edges of the mesh.
    WeightProblem(const TriangleMesh& mesh, const Rig& rig);
    //! The same handles with what they hold given.
    WeightProblem(const TriangleMesh& mesh, const Rig& rig, WeightConditions conditions);
};

//! What the solver of a family found.
struct WeightSolution {
    Eigen::MatrixXd W;  //!< #V x #columns
    int iterations = 0;
    bool converged = true;
    double kkt_residual = 0;
    std::string fallback;
};

//! Columns of a rig's handles, in their order.
std::vector<WeightColumn> weight_columns(const Rig& rig);

//! Q = L M^-1 L, the Laplacian energy as a quadratic form, scaled by the subject's squared diagonal so that it is free
//! of units, plus the cotangent stiffness of triangles times rho = s - 1 where their stiffness s is above 1
//! (ALGORITHMS.md section 6). #V x #V, symmetric positive semi-definite; rows sum to 0.
SparseMatrix laplacian_energy(const WeightProblem& problem);

//! Solves min w^T Q w for all columns at once, w = conditions at their vertices. Q as `laplacian_energy` or
//! `cotangent_stiffness`. \return #V x #columns; rows sum to 1 to round-off.
//! \throw InvalidInput  the mesh's triangles are too bad to factorise.
Eigen::MatrixXd unbounded_weights(const SparseMatrix& Q, const WeightConditions& conditions);

}  // namespace puppetwarp
