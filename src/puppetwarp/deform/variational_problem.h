#pragma once
// Private header.

#include <puppetwarp/deform/deformer.h>
#include <puppetwarp/deform/descent.h>
#include <puppetwarp/deform/goals.h>
#include <puppetwarp/rig/disc_holder.h>

#include <memory>
#include <mutex>

namespace puppetwarp {

//! One of `arap`, `smooth-arap`, `fold-free` on one mesh with one rig: its energy, how the handles hold, and the
//! metrics to descend by. Immutable but for what it keeps for later; safe to share between threads.
class VariationalProblem {
public:
    //! \throw InvalidInput  the rig does not fit the mesh or the method.
    VariationalProblem(const MethodOptions& options, const TriangleMesh& mesh, const Rig& rig);
    //! The same method on the same mesh with another rig: shares all that does not change.
    //! \throw InvalidInput  the rig does not fit the mesh or the method.
    VariationalProblem(const VariationalProblem& before, const Rig& rig);

    const MethodOptions& options() const { return subject_->options; }
    const Binding& binding() const { return binding_; }
    const Eigen::VectorXcd& rest() const { return subject_->rest; }
    double size() const { return subject_->size; }
    bool has_unknowns() const { return factors_->unknowns > 0; }
    //! Whether handles are springs: then the energy must never be infinite.
    bool guards_folds() const { return options().method == Method::fold_free; }

    //! \throw InvalidInput  the pose does not fit the rig.
    Goals goals(const Pose& pose) const;
    //! What is to be minimised for these goals; where a scale is fixed and the angle free, around x.
    Objective objective(const Goals& goals, const Eigen::VectorXcd& x) const;
    //! Points an objective of this problem at other goals.
    void aim(Objective& objective, const Goals& goals, const Eigen::VectorXcd& x) const;
    //! Puts the vertices that handles hold exactly.
    void place_held(const Goals& goals, Eigen::VectorXcd& x) const;

    //! Whether no triangle is folded over and none is stretched as far as crushed limbs are.
    bool looks_natural(const Eigen::VectorXcd& x) const;
    //! Whether every scale that is fixed with a free angle is met at x.
    bool scales_settled(const Goals& goals, const Eigen::VectorXcd& x) const;

    //! A metric for positions near x, good for the objective's conditions.
    std::shared_ptr<ConstrainedMetric> metric(const Eigen::VectorXcd& x, const Objective& objective) const;
    //! The true one, where `metric` saves the work.
    std::shared_ptr<ConstrainedMetric> exact_metric(const Eigen::VectorXcd& x, const Objective& objective) const;
    //! Whether `metric` is the same at any x.
    bool constant_metric() const { return factors_->constant != nullptr; }
    //! Whether metrics of the other problem have the Hessians of this one's.
    bool shares_factors_with(const VariationalProblem& other) const { return factors_ == other.factors_; }
    //! A metric of the other problem, whose factors are shared, made good for this one's handles.
    std::shared_ptr<ConstrainedMetric> adopted(const ConstrainedMetric& metric, const VariationalProblem& other,
                                               const Objective& objective) const;
    //! Makes a metric good for other conditions.
    //! \return as ConstrainedMetric::choose.
    bool choose(ConstrainedMetric& metric, const Objective& objective) const;

private:
    // What depends on the mesh, the method and the stiffness.
    struct Subject {
        Subject(const MethodOptions& options, const TriangleMesh& mesh, Eigen::VectorXd stiffness);
        MethodOptions options;
        TriangleMesh mesh;
        DiscHolder discs;
        Eigen::VectorXd stiffness;  // of triangles
        Eigen::VectorXcd rest;
        double size;
        Eigen::VectorXi component;
        std::unique_ptr<const Energy> energy;
    };
    // What depends on which vertices are free.
    struct Factors {
        std::shared_ptr<const Subject> subject;
        std::vector<bool> free;
        std::vector<int> sprung;
        std::ptrdiff_t unknowns = 0;
        VertexSprings grounds;
        std::shared_ptr<const FactoredHessian> constant;
        mutable std::once_flag factory_made;
        mutable std::unique_ptr<const HessianFactory> factory;
    };

    void take_hold_of_subject();
    std::shared_ptr<Factors> free_vertices() const;
    void prepare(Factors& factors) const;
    double spring_stiffness() const;
    VertexSprings grounds_for(const std::vector<bool>& free) const;
    bool leaves_rigid_freedom(const Objective& objective) const;
    const HessianFactory& factory() const;

    Rig rig_;
    std::shared_ptr<const Subject> subject_;
    std::shared_ptr<const Factors> factors_;
    Binding binding_;
    std::vector<ComplexRow> rows_;       // of each hold: the mean, the turn times the radius
    std::vector<int> component_places_;  // how many different places are held in each component, up to 2
};

//! Whether a method is one of those.
bool is_variational(Method method);

}  // namespace puppetwarp
