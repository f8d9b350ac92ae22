#pragma once

#include "model/shape.h"

#include <puppetwarp/base/progress.h>
#include <puppetwarp/deform/interactive_solver.h>

#include <chrono>
#include <memory>
#include <string>

namespace puppetwarp::ui {

//! How much time a drag takes to follow the pointer.
struct Pace {
    double live_budget_ms = 12;        //!< of one live shape: what a frame leaves beside drawing; 0: one iteration
    std::chrono::seconds patience{5};  //!< what has not converged after this while never will
    //! Factors are refreshed by a thread of their own. False, and each live shape waited for until there is no `more`
    //! of it: where a drag ends does not depend on timing.
    bool metric_worker = true;
};

//! The library's pipeline, run as far as something has changed since the last time.
//! What it keeps belongs to one thread.
class ShapeMaker {
public:
    //! \param longest_side_px  how large a picture the screen's memory takes.
    explicit ShapeMaker(int longest_side_px, const Pace& pace = {}) : longest_side_px_(longest_side_px), pace_(pace) {}

    //! Never throws what the library refuses: that is `Shape::error`, beside all that could be made.
    //! \throw Cancelled
    std::shared_ptr<const Shape> make(const ShapeRequest& request, Progress& progress);

private:
    void update_subject(const Puppet& puppet, Progress& progress);
    void fill_subject(Progress& progress);
    void update_mesh(const Puppet& puppet, Progress& progress);
    Rig rig(const Puppet& puppet);
    void update_solver(const Puppet& puppet, Progress& progress);
    void deform(const ShapeRequest& request, Shape& shape, Progress& progress);
    const Eigen::VectorXi& order(const ShapeRequest& request);
    InteractiveFrame follow(const ShapeRequest& request, Shape& shape, Progress& progress);
    InteractiveFrame advance(const Pose& pose);
    InteractiveFrame settle(const ShapeRequest& request, Shape& shape, Progress& progress);

    int longest_side_px_;
    Pace pace_;
    std::string subject_key_;
    std::shared_ptr<const Subject> subject_;
    std::string mesh_key_;
    std::shared_ptr<const TriangleMesh> mesh_;
    std::string stiffness_key_;
    std::vector<Stiffness> stiffness_;  // of subject_, pictures loaded
    std::string method_key_;
    std::string rig_key_;
    std::unique_ptr<InteractiveSolver> solver_;  // of mesh_, and of what these two keys stand for
    bool begun_ = false;                         // solver_ has shown something
    std::uint64_t live_revision_ = 0;            // of the last live request, and since when it is the last
    std::chrono::steady_clock::time_point resting_since_;
    Eigen::MatrixX2d last_moved_;  // of mesh_
    std::string order_key_;
    Eigen::VectorXi order_;  // in which the triangles of mesh_ are painted
};

}  // namespace puppetwarp::ui
