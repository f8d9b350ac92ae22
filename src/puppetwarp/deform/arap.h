#pragma once
// Private header.

#include <puppetwarp/deform/arap_minimiser.h>
#include <puppetwarp/deform/deformer.h>

namespace puppetwarp {

//! `arap`: least energy of ArapCells that meets the handles. A point's fixed angle theta is Im(e^(-i theta) mean f_z) =
//! 0 over its disc, together with a scale s it is mean f_z = s e^(i theta).
//! The handles are led to their targets in steps small enough to follow, from the rest pose brought as near to
//! them as a rigid motion can, or from the given start.
class ArapDeformer : public Deformer {
public:
    ArapDeformer(const MethodOptions& options, const TriangleMesh& mesh, const Rig& rig);
    Deformation deform(const Pose& pose, const Eigen::MatrixX2d* start, Progress& progress) const override;

private:
    // Where a hold is led: the value of its mean, and of its turn where that is fixed.
    struct Goal {
        std::complex<double> mean;
        double angle = 0;
        double scale = 0;  // 0: free
        bool turned = false;
    };
    struct Problem {
        ConstraintSpace constraints;
        Eigen::VectorXd d;
    };

    std::vector<Goal> goals_of(const Targets& targets) const;
    std::vector<Goal> goals_at(const Eigen::VectorXcd& x, const std::vector<Goal>& goals) const;
    Eigen::VectorXcd rigid_start(const std::vector<Goal>& goals) const;
    int steps_between(const std::vector<Goal>& from, const std::vector<Goal>& to) const;
    void place_fixed(const std::vector<Goal>& goals, Eigen::VectorXcd& x) const;
    Problem problem_of(const std::vector<Goal>& goals, const Eigen::VectorXcd& x) const;
    bool settled(const Problem& problem, const Eigen::VectorXcd& x) const;
    ArapMinimum lead(const std::vector<Goal>& goals, Eigen::VectorXcd& x, Progress& progress) const;
    bool keep_facing(const Eigen::VectorXcd& x, std::vector<Goal>& goals) const;
    double largest_error(const std::vector<Goal>& goals, const Eigen::VectorXcd& x) const;

    MethodOptions options_;
    Eigen::VectorXcd rest_;
    double size_;
    Rig rig_;
    TriangleMesh mesh_;
    Binding binding_;
    std::vector<ArapHold> holds_;
    std::vector<std::complex<double>> rest_means_;
    ArapCells cells_;
    ArapSystem system_;
};

}  // namespace puppetwarp
