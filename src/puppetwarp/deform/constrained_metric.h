#pragma once
// Private header.

#include <puppetwarp/deform/factored_hessian.h>
#include <puppetwarp/rig/binding.h>

#include <Eigen/LU>
#include <Eigen/QR>

#include <map>
#include <optional>

namespace puppetwarp {

//! One real condition on the positions: Re(conj(direction) rows[row](x)) = value.
struct Condition {
    int row = 0;                         //!< among the rows of the metric
    std::complex<double> direction = 1;  //!< of length 1
    double value = 0;
    bool fixes_angle = false;  //!< whether it keeps what it holds from turning
};

//! The value of a condition's left side.
double left_side(const Condition& condition, const std::vector<ComplexRow>& rows, const Eigen::VectorXcd& x);

//! The Newton step of an energy under conditions on the positions: a factored Hessian that knows nothing of the
//! conditions, and a small dense system for them. So conditions come, go and turn without a new factor, for the
//! price of two solves for a row that is new; the grounds that made the Hessian definite are taken out again in the
//! same system (Woodbury). Conditions that repeat or contradict each other, or that no free vertex can meet, are met
//! in the least-squares sense.
class ConstrainedMetric {
public:
    //! \param grounds  as given to the Hessian.
    //! \param penalty  0: conditions hold exactly; else each is a spring of this stiffness.
    ConstrainedMetric(std::shared_ptr<const FactoredHessian> hessian, Eigen::Index vertices,
                      const VertexSprings& grounds, double penalty);

    //! The same Hessian for other rows, what was solved for known ones kept.
    //! \param old_of_new  for each of the new rows its index among the old, or -1.
    std::shared_ptr<ConstrainedMetric> with_rows(const std::vector<int>& old_of_new) const;

    //! Chooses the conditions that hold from now on.
    //! \param rows          of which conditions are made: always the same ones, or more at the end.
    //! \param keep_grounds  for handles that leave rigid motions free: the metric is then stiffer than the energy.
    //! \return whether these are others than before, but for their values: steps taken under the old ones are then none
    //!         that a descent may go on with.
    bool choose(const std::vector<ComplexRow>& rows, const std::vector<Condition>& conditions, bool keep_grounds);

    //! The p that minimises -Re<q, p> + p^T H p / 2 under the conditions that their left sides at p are `missing`, or 0
    //! where that is empty. With a penalty the conditions are springs, part of H, and `missing` is empty.
    Eigen::VectorXcd step(const Eigen::VectorXcd& q, const Eigen::VectorXd& missing = {}) const;

    //! `step` for no load: the cheapest move that changes the conditions' left sides by `missing`.
    Eigen::VectorXcd correction(const Eigen::VectorXd& missing) const;

    bool exact() const { return hessian_->exact(); }

private:
    // A row and what the Hessian makes of unit loads on its real and its imaginary part.
    struct Response {
        Eigen::VectorXcd re;
        Eigen::VectorXcd im;
    };
    using SharedResponse = std::shared_ptr<const Response>;
    // Re(conj(direction) row(x)) as one row, and its response: direction.real() re + direction.imag() im.
    struct Functional {
        ComplexRow row;
        std::complex<double> direction;
        SharedResponse response;

        double of(const Eigen::VectorXcd& x) const;
    };
    void factorise_system();
    Eigen::VectorXd forces_for(const Eigen::VectorXd& off) const;
    void bring_onto(const Eigen::VectorXd& missing, Eigen::VectorXcd& p) const;
    bool same_as_chosen(const std::vector<Condition>& conditions, bool keep_grounds) const;
    SharedResponse response(int key, const ComplexRow& row);

    std::shared_ptr<const FactoredHessian> hessian_;
    Eigen::Index vertices_;
    double penalty_;
    double ground_stiffness_;
    std::vector<ComplexRow> ground_rows_;
    std::map<int, SharedResponse> responses_;  // by row; grounds are -1, -2, ...
    std::optional<std::vector<Condition>> chosen_;
    bool grounds_kept_ = false;
    std::vector<Functional> functionals_;  // of what was chosen, then of the grounds
    Eigen::MatrixXd system_;               // its diagonal brought to 1 by `scale_` on both sides
    Eigen::VectorXd scale_;
    Eigen::PartialPivLU<Eigen::MatrixXd> factor_;
    std::optional<Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>> deficient_factor_;  // where it is singular
};

}  // namespace puppetwarp
