#pragma once
// Private header.

#include <puppetwarp/deform/deformer.h>
#include <puppetwarp/deform/descent.h>
#include <puppetwarp/deform/goals.h>

#include <memory>
#include <mutex>

namespace puppetwarp {

//! One of `arap`, `smooth-arap`, `fold-free` on one mesh with one rig: its energy, how the handles hold, and the
//! metrics to descend by. Immutable but for what it keeps for later; safe to share between threads.
class VariationalProblem {
public:
    //! \throw InvalidInput  the rig does not fit the mesh or the method.
    VariationalProblem(const MethodOptions& options, const TriangleMesh& mesh, const Rig& rig);

    const MethodOptions& options() const { return options_; }
    const Binding& binding() const { return binding_; }
    const Eigen::VectorXcd& rest() const { return rest_; }
    double size() const { return size_; }
    bool has_unknowns() const { return unknowns_ > 0; }
    //! Whether handles are springs: then the energy must never be infinite.
    bool guards_folds() const { return options_.method == Method::fold_free; }

    //! \throw InvalidInput  the pose does not fit the rig.
    Goals goals(const Pose& pose) const;
    //! What is to be minimised for these goals; where a scale is fixed and the angle free, around x.
    Objective objective(const Goals& goals, const Eigen::VectorXcd& x) const;
    //! Points an objective of this problem at other goals.
    void aim(Objective& objective, const Goals& goals, const Eigen::VectorXcd& x) const;
    //! Puts the vertices that handles hold exactly.
    void place_held(const Goals& goals, Eigen::VectorXcd& x) const;

    //! Whether every scale that is fixed with a free angle is met at x.
    bool scales_settled(const Goals& goals, const Eigen::VectorXcd& x) const;

    //! A metric for positions near x, good for the objective's conditions.
    std::shared_ptr<ConstrainedMetric> metric(const Eigen::VectorXcd& x, const Objective& objective) const;
    //! The true one, where `metric` saves the work.
    std::shared_ptr<ConstrainedMetric> exact_metric(const Eigen::VectorXcd& x, const Objective& objective) const;
    //! Whether `metric` is the same at any x.
    bool constant_metric() const { return constant_ != nullptr; }
    //! Makes a metric good for other conditions.
    void choose(ConstrainedMetric& metric, const Objective& objective) const;

private:
    std::unique_ptr<Energy> make_energy(const TriangleMesh& mesh) const;
    void choose_grounds(const TriangleMesh& mesh);
    bool leaves_rigid_freedom(const Objective& objective) const;
    const HessianFactory& factory() const;

    MethodOptions options_;
    TriangleMesh mesh_;
    Rig rig_;
    Eigen::VectorXcd rest_;
    double size_;
    Binding binding_;
    std::unique_ptr<Energy> energy_;
    std::vector<ComplexRow> rows_;  // of each hold: the mean, the turn times the radius
    std::vector<bool> free_;
    std::vector<int> sprung_;
    std::vector<int> component_places_;  // how many different places are held in each component
    Eigen::VectorXi component_;
    Eigen::Index unknowns_ = 0;
    VertexSprings grounds_;
    std::shared_ptr<const FactoredHessian> constant_;
    mutable std::once_flag factory_made_;
    mutable std::unique_ptr<const HessianFactory> factory_;
};

}  // namespace puppetwarp
