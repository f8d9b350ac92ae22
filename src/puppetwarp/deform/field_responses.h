#pragma once
// Private header.

#include <puppetwarp/deform/field_inverse.h>
#include <puppetwarp/deform/response_system.h>
#include <puppetwarp/rig/binding.h>

#include <memory>
#include <optional>
#include <vector>

namespace puppetwarp {

//! What one soft hold is to get.
struct FieldGoal {
    std::complex<double> mean;                  //!< of the displacement
    std::optional<std::complex<double>> turn;   //!< mean f_z of the map, 1 at rest
    std::optional<std::complex<double>> shear;  //!< mean f_zbar of the map, 0 at rest
    std::optional<double> scale;                //!< |mean f_z|, its direction free; only without `turn`
};

//! The fields of least energy that soft holds (points' discs, discs along bones) call for. Each hold's rows are real:
//! its mean, and the mean gradient over it. The field that answers a unit multiplier on a row is computed once;
//! what a pose asks for is then a small dense system in these responses, and their sum. Immutable.
class FieldResponses {
public:
    //! \param held   #V, vertices whose displacement `inverse` was given.
    //! \param known  of the same inverse for other holds, to take over what is the same; or null.
    FieldResponses(std::shared_ptr<const FieldInverse> inverse, const Eigen::VectorXi& component,
                   const std::vector<bool>& held, const std::vector<Hold>& holds, const FieldResponses* known);

    //! Adds to the displacement u (#V) the field of least energy, 0 at held vertices, that brings it to the goals, as
    //! near as these can be met together. A scale alone comes with the turn that costs least.
    //! \param goals  one for each hold; scales alone turn into the turns that were found.
    void bring_to(std::vector<FieldGoal>& goals, Eigen::VectorXcd& u) const;

    //! The largest distance of u from the goals, px; turns and shears as lengths at the holds' radius.
    double largest_error(const std::vector<FieldGoal>& goals, const Eigen::VectorXcd& u) const;

private:
    using RealRow = std::vector<std::pair<int, double>>;

    // The mean of a hold and, where it has a turn, radius * d/dx and radius * d/dy; the fields that answer them.
    struct Response {
        std::vector<RealRow> rows;
        double radius_px = 1;
        int constant = -1;  // number of the component's constant, where no vertex of it is held
        int gradient = -1;  // number among the holds with gradient rows
        std::shared_ptr<const Eigen::MatrixXd> fields;  // #V x #rows
        Eigen::RowVectorXd largest;                     // of each field's values, absolute

        std::complex<double> turn(const Eigen::VectorXcd& u) const;
        std::complex<double> shear(const Eigen::VectorXcd& u) const;
    };

    static Response rows_of(const Hold& hold);
    void respond();
    ResponseSystem::Compliance compliance() const;
    Eigen::MatrixXd field_of(const ResponseSystem::Multipliers& multipliers, bool small) const;
    Eigen::MatrixX2d multipliers_of(const ResponseSystem::Multipliers& multipliers, std::size_t hold) const;
    void correct(std::vector<FieldGoal>& goals, bool again, Eigen::VectorXcd& u) const;

    std::shared_ptr<const FieldInverse> inverse_;
    std::vector<int> constant_of_;  // #V: number of the component's constant, or -1
    int constants_ = 0;
    int gradients_ = 0;
    std::vector<Response> responses_;
    std::optional<ResponseSystem> system_;
};

}  // namespace puppetwarp
