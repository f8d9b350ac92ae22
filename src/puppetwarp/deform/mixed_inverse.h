#pragma once
// Private header.

#include <puppetwarp/deform/field_inverse.h>
#include <puppetwarp/solve/block_ldlt.h>

#include <optional>

namespace puppetwarp {

//! FieldInverse for any held vertices, and for a first-order part beside the other. The unknowns of a vertex are
//! w_0 = u and w_j = s M^-1 L w_(j-1), j < order, with a typical area s; a held vertex keeps its w_1, w_2, ...
//! Their equations, last first, make a symmetric system of one block a vertex (mixed finite elements: Ciarlet & Raviart
//! 1974, Jacobson et al. 2010), which is factored as it is; solutions are refined.
class MixedInverse final : public FieldInverse {
public:
    MixedInverse(const FieldEnergy& energy, const Eigen::VectorXi& component, const std::vector<bool>& held);

    Eigen::Index vertices() const override { return n_; }
    Eigen::MatrixXd respond(const Eigen::MatrixXd& loads) const override;
    Eigen::MatrixXd extend(const Eigen::MatrixXd& values) const override;

private:
    BlockMatrix block_matrix() const;
    Eigen::MatrixXd system_times(const Eigen::MatrixXd& w) const;
    Eigen::MatrixXd solve(const Eigen::MatrixXd& right_hand_side) const;
    Eigen::MatrixXd level(const Eigen::MatrixXd& w, int j) const;

    Eigen::Index n_;
    int order_;
    SparseMatrix L_;
    Eigen::VectorXd M_;       // over s; 1 at a vertex of no triangle
    double load_scale_ = 1;   // of the equations of u
    double first_order_ = 0;  // weight of K_ in them
    SparseMatrix K_;
    Eigen::VectorXd moving_;   // 0 where u is given or grounded, else 1
    std::vector<bool> whole_;  // whether the vertex's component has no held vertex
    ComponentMeans means_;
    std::optional<BlockLdlt> factor_;
};

}  // namespace puppetwarp
