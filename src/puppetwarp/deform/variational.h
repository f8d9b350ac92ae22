#pragma once
// Private header.

#include <puppetwarp/deform/variational_problem.h>

namespace puppetwarp {

//! `arap`, `smooth-arap` and `fold-free`: the least energy that meets the handles, exactly in the first two, as strong
//! springs in the last, which never folds a triangle over. A point's fixed angle theta is Im(e^(-i theta) mean f_z) = 0
//! over its disc, together with a scale s it is mean f_z = s e^(i theta), a scale alone is |mean f_z| = s, at the angle
//! that the disc came with where none is settled.
//! The energies have many minima: the handles are led to their targets in strides small enough to follow, from the rest
//! pose brought as near to them as a rigid motion can, or from the given start. Where that turns something far or
//! squeezes it, other ways are gone too, straight on and with whole limbs turned in either sense, and the best end
//! counts; iterations and energies are those of its way. Where a pose says how far free angles turned, all that is free
//! first follows of itself; where it does not end turned so far, another way is gone with these angles held, with as
//! many iterations again, and the end counts that is nearer to it. A start has turned already: what the pose says of
//! that is not asked.
class VariationalDeformer : public Deformer {
public:
    explicit VariationalDeformer(std::shared_ptr<const VariationalProblem> problem) : problem_(std::move(problem)) {}
    std::unique_ptr<Deformer> with_rig(const Rig& rig) const override;
    Deformation deform(const Pose& pose, const Eigen::MatrixX2d* start, Progress& progress) const override;

private:
    struct Outcome {
        Eigen::VectorXcd x;
        Minimum minimum;
        double value = 0;
        double turn_error = 0;  // how far the most erring of the turns is from what the goals say
    };
    Outcome lead(const Eigen::VectorXcd& start, const Goals& goals, Way way, int most_iterations,
                 Progress& progress) const;
    Outcome best_lead(const Eigen::VectorXcd& start, const Goals& goals, bool warm, Progress& progress) const;
    Goals facing_as(const Eigen::VectorXcd& x, Goals goals) const;
    Goals turned_by(const Eigen::VectorXcd& start, Goals goals, const GoalPath& path, double sense) const;
    bool keep_facing(const Eigen::VectorXcd& x, Goals& goals) const;

    std::shared_ptr<const VariationalProblem> problem_;
};

}  // namespace puppetwarp
