#pragma once
// Private header.

#include <Eigen/Core>
#include <Eigen/QR>

#include <complex>
#include <vector>

namespace puppetwarp {

//! What a mean f_z or f_zbar has to become, written with the real rows d/dx and d/dy of one hold.
struct GradientGoal {
    enum class Row { turn, shear };  // (d/dx - i d/dy) / 2, (d/dx + i d/dy) / 2
    int hold = 0;                    //!< among those with gradient rows
    Row row = Row::turn;
    std::complex<double> now;     //!< its value before the field is added
    std::complex<double> wanted;  //!< after; where `scale` is above 0, set to the best of this length
    double scale = 0;             //!< above 0: of free direction
};

//! The dense system of the multipliers on soft holds' rows: means, and mean gradients. Immutable.
class ResponseSystem {
public:
    //! Response of each row to a unit multiplier on each other, symmetric positive semi-definite once what does not sum
    //! to 0 over a component is left to its constant.
    struct Compliance {
        Eigen::MatrixXd means;           //!< #holds x #holds
        Eigen::MatrixXd gradient_means;  //!< #gradient rows x #holds; two rows a hold that has them
        Eigen::MatrixXd gradients;       //!< #gradient rows x #gradient rows
        std::vector<int> constant_of;    //!< #holds, number of the constant that its mean holds, or -1
        int constants = 0;
    };
    explicit ResponseSystem(Compliance compliance);

    struct Multipliers {
        Eigen::VectorXcd means;
        Eigen::VectorXcd gradients;
        Eigen::VectorXcd constants;
    };
    //! Multipliers of the field of least energy whose means are `means` and that meets the goals; of rows that depend
    //! on each other as few as can be. Directions that are free become those of least energy: each has a closed form
    //! when the others are given, and these are taken in turns until they settle.
    Multipliers solve(const Eigen::VectorXcd& means, std::vector<GradientGoal>& goals) const;

private:
    using Complex = std::complex<double>;
    using Solver = Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>;

    template <typename Values>
    Values solve_means(const Values& means) const;
    Eigen::MatrixXcd goal_compliance(const std::vector<GradientGoal>& goals) const;

    Compliance compliance_;
    Eigen::VectorXd scale_;        // #holds + #constants: brings the rows to similar size
    Solver means_solver_;          // of the means alone
    Eigen::MatrixXd undone_;       // multipliers of means and constants that answer each gradient row's effect on means
    Eigen::MatrixXd constrained_;  // compliance of the gradient rows while the means are held
};

}  // namespace puppetwarp
