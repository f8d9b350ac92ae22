#pragma once
// Private header.

#include <puppetwarp/rig/binding.h>

#include <cmath>
#include <optional>
#include <vector>

namespace puppetwarp {

//! Where one hold is to be: the value of its mean, and of its turn where that is fixed.
struct HoldGoal {
    std::complex<double> mean;
    std::optional<double> angle_rad;
    std::optional<double> scale;
    std::optional<double> way_rad;  //!< of a free angle: how far it is to turn on the way, whole turns counted

    bool operator==(const HoldGoal&) const = default;
};

//! Where all that is held is to be.
struct Goals {
    std::vector<HoldGoal> holds;  //!< in the order of Binding::holds
    Eigen::VectorXcd vertices;    //!< positions, in the order of Binding::vertices

    bool operator==(const Goals& other) const { return holds == other.holds && vertices == other.vertices; }
};

//! The goals that targets ask for. \param rest  #V
Goals goals_of(const Targets& targets, const Binding& binding, const Eigen::VectorXcd& rest);

//! What x has now of the goals: the same fields fixed, angles counted so that the way to `goals` is the short one,
//! unless that says how far.
Goals goals_at(const Eigen::VectorXcd& x, const Binding& binding, const Goals& goals);

//! Largest distance from what the goals ask for, turns measured at the hold's radius. px
double largest_error(const Eigen::VectorXcd& x, const Binding& binding, const Goals& goals);

//! The rest pose moved rigidly to where the goals fit best: exact when they are a rigid motion. Vertices that `free`
//! excludes and no handle holds stay at rest.
Eigen::VectorXcd rigid_fit(const Eigen::VectorXcd& rest, const Binding& binding, const Goals& goals);

//! How handles are led to their goals.
enum class Way {
    straight,  //!< along straight lines
    turning,   //!< along spirals; a free angle is fixed on the way where the goals say how far it turns
    following  //!< along the same spirals, free angles left free
};

//! A way from some goals to others in strides that a descent can follow. What turned about the rest of the handles is
//! led along a logarithmic spiral about them, not through them: straight across a joint, a limb would come out
//! mirrored.
class GoalPath {
public:
    //! \param size  bounding diagonal of the mesh.
    GoalPath(const Binding& binding, const Goals& from, const Goals& to, double size, Way way);

    //! Strides, at least 1. \param stride_rad  the widest turn of one.
    int strides(double stride_rad) const;
    //! The widest angle of any spiral.
    double widest_turn_rad() const { return widest_turn_; }
    //! The angle of a hold's spiral.
    double turn_rad(std::size_t hold) const { return holds_[hold].growth.imag(); }
    //! By what share a hold's distance from its spiral's centre changes; the least of all.
    double squeeze(std::size_t hold) const { return std::exp(holds_[hold].growth.real()); }
    double strongest_squeeze() const;
    //! At a share of the way in (0, 1]; at 1 exactly the goals given.
    Goals at(double share) const;
    //! The goals given, free angles fixed at how far the goals say they turn.
    Goals held_end() const;

private:
    // A point led about a centre that moves itself: centre(share) + arm * exp(share * growth).
    struct Spiral {
        std::complex<double> centre_from, centre_to, arm, growth;
        std::complex<double> at(double share) const;
    };
    Spiral spiral_of(std::size_t hold, const Goals& from, const Goals& to, const Binding& binding) const;

    Goals from_;
    Goals to_;
    double size_;
    Way way_;
    std::vector<Spiral> holds_;
    std::vector<Spiral> vertices_;
    double widest_turn_ = 0;
};

}  // namespace puppetwarp
