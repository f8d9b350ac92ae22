#pragma once
// Private header: what the blends of rigid motions share.

#include <puppetwarp/deform/linear_blend.h>
#include <puppetwarp/deform/skinning_motions.h>

#include <limits>

namespace puppetwarp {

//! Vertices at which a mean of motions is nearly undefined: motions that are a whole turn apart have none.
struct UnsteadyVertices {
    int count = 0;
    int worst = -1;  //!< a vertex
    double least = std::numeric_limits<double>::infinity();

    //! \param steadiness  of the mean at vertex v: 1 where all motions turn alike, 0 where there is no mean.
    void look_at(Eigen::Index v, double steadiness) {
        if (!(steadiness < 0.1)) return;
        ++count;
        if (!(steadiness < least)) return;
        least = steadiness;
        worst = static_cast<int>(v);
    }
};

//! What a blend of rigid motions or similarities makes of positions.
struct BlendedPositions {
    Eigen::VectorXcd x;  //!< #V
    UnsteadyVertices unsteady;
};

//! First phase of both blends: the shears, each about its column's centre, blended linearly. The mean of symmetric
//! positive definite matrices is one: nothing collapses or turns over.
//! \return #V positions, to which the blend of the similarities is applied.
Eigen::VectorXcd blend_shears(const WeightRows& W, const Eigen::VectorXcd& z, const std::vector<SplitMotion>& motions);

}  // namespace puppetwarp
