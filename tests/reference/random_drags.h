#pragma once

#include <puppetwarp/deform/interactive_solver.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <random>

namespace puppetwarp::reference {

//! What came of some drags.
struct DragTally {
    int drags = 0;
    int calls = 0;               //!< of advance(), restart() and deform()
    int refused = 0;             //!< handles or poses that contradict themselves
    int folds = 0;               //!< calls that left a triangle folded over
    int not_finite = 0;          //!< calls with a number that is none
    double worst_rise = 0;       //!< relative growth of the energy between calls with one pose, once it is reached
    std::uint32_t worst_at = 0;  //!< seed of the subject of the last fold or number that is none
};

//! Drags of all kinds, one after another, on random subjects: pins that move a little, far outside, across the body,
//! in the places of others, at given angles and scales; vertices and regions; rigs that change on the way. The same for
//! a seed.
class RandomDrags {
public:
    //! \param most_vertices  of a subject, about, from 100.
    RandomDrags(const MethodOptions& options, std::uint32_t seed, int most_vertices, bool worker);

    //! One drag: a few frames on the way, some more in which the pose rests, sometimes the same pose from rest.
    void drag();
    const DragTally& tally() const { return tally_; }

private:
    double uniform(double low, double high);
    int below(int count);
    Point place();
    Handle handle();
    HandlePose target(const Handle& handle);
    Pose aim();
    void choose_subject();
    void change_rig();
    void judge(const Eigen::MatrixX2d& V);
    void deform_at_once(const Pose& pose);
    void guarded(const std::function<void()>& work);

    MethodOptions options_;
    int most_vertices_;
    bool worker_;
    std::mt19937 random_;
    std::uint32_t seed_;
    TriangleMesh mesh_;
    double size_ = 1;
    Rig rig_;
    Pose pose_;
    int made_ = 0;  // handles, for their ids
    int left_ = 0;  // drags until the next subject
    Eigen::MatrixX2d last_;
    std::unique_ptr<InteractiveSolver> solver_;
    DragTally tally_;
};

}  // namespace puppetwarp::reference
