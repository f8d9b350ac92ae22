#pragma once
// Private header.

#include <Eigen/Core>

#include <deque>

namespace puppetwarp {

//! Anderson mixing of a fixed-point iteration x -> g(x): the combination of the last values g, weights summing to 1,
//! whose combined residual g(x) - x is least. Combinations keep every linear equation that all g meet, and are the same
//! combinations when everything is turned. Anderson 1965; type II of Walker & Ni 2011.
class AndersonMixing {
public:
    //! \param x  where the iteration stood.   \param g  where it went from there.   \return where to go on.
    Eigen::VectorXcd next(const Eigen::VectorXcd& x, const Eigen::VectorXcd& g);

private:
    std::deque<Eigen::VectorXcd> value_steps_;     // differences of successive g
    std::deque<Eigen::VectorXcd> residual_steps_;  // of successive g - x
    Eigen::VectorXcd value_, residual_;            // the last ones
    double least_ = 0;                             // length of a residual so far
};

}  // namespace puppetwarp
