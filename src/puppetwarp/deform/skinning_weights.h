#pragma once
// Private header.

#include <puppetwarp/deform/linear_blend.h>
#include <puppetwarp/deform/skinning_motions.h>
#include <puppetwarp/weights/weights.h>

#include <string>
#include <vector>

namespace puppetwarp {

//! Weights as blends use them.
struct SkinningWeights {
    std::vector<WeightColumn> columns;
    WeightRows rows;  //!< #V x #columns without the zeros
    //! Imaginary parts of Cauchy coordinates, #V x #columns, or empty: a column's move times i times its weight is
    //! added to what a blend gives.
    Eigen::MatrixXd imaginary;
    //! Vertices that one column has alone: what a handle holds. Ascending.
    struct Held {
        Eigen::Index vertex;
        std::size_t column;
    };
    std::vector<Held> held;
    std::vector<std::string> warnings;  //!< of the weights; that and how they did not converge

    //! \throw InvalidInput  the weights are not of this mesh and rig, or not finite.
    SkinningWeights(const Weights& weights, const TriangleMesh& mesh, const Rig& rig);

    //! Adds the imaginary parts' share to positions x (#V).
    void add_imaginary(const std::vector<ColumnMotion>& motions, Eigen::VectorXcd& x) const;
    //! Largest distance of a held vertex, rest place z (#V), from where its column takes it. px
    double largest_error(const std::vector<ColumnMotion>& motions, const Eigen::VectorXcd& z,
                         const Eigen::VectorXcd& x) const;
};

}  // namespace puppetwarp
