#pragma once
// Private header.

#include <puppetwarp/deform/constrained_metric.h>
#include <puppetwarp/deform/energy.h>

namespace puppetwarp {

//! What a variational method minimises: an energy, with the handles either as exact conditions or as springs.
struct Objective {
    const Energy& energy;
    const std::vector<bool>& free;        //!< #V: whether a vertex may move
    const std::vector<ComplexRow>& rows;  //!< of which conditions are made
    double penalty = 0;                   //!< stiffness of springs; 0: conditions are exact
    std::vector<Condition> conditions;    //!< of the pose at hand
    std::vector<int> sprung;              //!< with a penalty: vertices on springs of their own
    Eigen::VectorXcd anchors;             //!< where these are drawn to

    //! Energy plus springs, px^2; infinite where the energy is.
    double value(const Eigen::VectorXcd& x) const;
    //! \param g  #V, 0 at the vertices that may not move.   \return the value.
    double gradient(const Eigen::VectorXcd& x, Eigen::VectorXcd& g) const;
    //! What the conditions' left sides lack at x; one number a condition.
    Eigen::VectorXd missing(const Eigen::VectorXcd& x) const;

private:
    double spring_value(const Eigen::VectorXcd& x) const;
};

}  // namespace puppetwarp
