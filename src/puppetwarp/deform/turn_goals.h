#pragma once
// Private header.

#include <Eigen/Core>

#include <complex>
#include <vector>

namespace puppetwarp {

//! What a pose fixes of one row: the turn or the shear of a hold, times its radius.
struct RowGoal {
    enum class Kind {
        value,      //!< it is `value`
        direction,  //!< it has the direction of `value`, of any length above a tenth of that; else it becomes `value`
        length      //!< it has the length of `value`, in any direction
    };
    int row = 0;
    Kind kind = Kind::value;
    std::complex<double> value;
};

//! How far a row is from its goal, in its own unit.
double distance_to(const RowGoal& goal, const std::complex<double>& row);

//! By which rows are brought to their goals.
struct RowSteps {
    Eigen::VectorXcd multipliers;  //!< one a row, 0 where nothing is fixed
    Eigen::VectorXcd modes;        //!< one a column of `modes`
};

//! Meets goals on rows that answer linearly: f = f0 + response multipliers + modes coefficients, with least energy
//! multipliers^H response multipliers. A length is met along the direction that the row has of itself, and that is
//! followed until it is settled; where it does not settle it is kept. Goals that contradict each other are met in the
//! least-squares sense.
//! \param f0        #rows, as they are.
//! \param response  #rows x #rows, Hermitian, positive semi-definite.
//! \param modes     #rows x #modes: answers that cost no energy.
RowSteps meet(const std::vector<RowGoal>& goals, const Eigen::VectorXcd& f0, const Eigen::MatrixXcd& response,
              const Eigen::MatrixXcd& modes);

}  // namespace puppetwarp
