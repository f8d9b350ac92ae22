#include "model/shape_maker.h"

#include "model/puppet_edits.h"
#include "model/shown_picture.h"

#include <puppetwarp/base/errors.h>
#include <puppetwarp/cutout/fill_behind.h>
#include <puppetwarp/project/pipeline.h>
#include <puppetwarp/project/stiffness_pictures.h>
#include <puppetwarp/rig/depth.h>
#include <puppetwarp/warp/painters_order.h>

#include <exception>
#include <thread>
#include <utility>

namespace puppetwarp::ui {

namespace {

// A background that is none is as good as none until the export says what is wrong with it.
Background background_of(const Puppet& puppet) {
    try {
        return background_from_name(puppet.background.value_or("transparent"));
    } catch (const Error&) {
        return {};
    }
}

// The parts of a puppet that a stage depends on, as text: two equal texts ask for the same.
std::string subject_key(const Puppet& puppet) {
    Puppet part;
    part.image = resolve(puppet, puppet.image).string();
    part.cutout = puppet.cutout;
    if (!part.cutout.path.empty()) part.cutout.path = resolve(puppet, puppet.cutout.path).string();
    part.background = background_of(puppet).kind == Background::Kind::keep ? "keep" : "transparent";
    return to_json(part);
}

std::string mesh_key(const Puppet& puppet) {
    Puppet part;
    part.mesh = puppet.mesh;
    // Bones and cages become edges; points become vertices where weights hold them.
    const bool points = uses_weights(puppet.method.method);
    for (const Handle& handle : puppet.rig.handles) {
        const bool edges =
            std::holds_alternative<BoneHandle>(handle.shape) || std::holds_alternative<CageHandle>(handle.shape);
        const bool vertex = points && std::holds_alternative<PointHandle>(handle.shape);
        if (edges || vertex) part.rig.handles.push_back(handle);
    }
    return to_json(part);
}

std::string method_key(const Puppet& puppet) {
    Puppet part;
    part.method = puppet.method;
    return to_json(part);
}

std::string rig_key(const Puppet& puppet) {
    Puppet part;
    part.rig = puppet.rig;
    return puppet.folder.string() + to_json(part);
}

// What depths depend on beside the mesh: handles, and what the pose says of their depths.
std::string order_key(const ShapeRequest& request) {
    Puppet part;
    part.rig.handles = request.puppet->rig.handles;
    Pose depths{"depths", 0, {}};
    for (const auto& [id, pose] : request.pose.handles) {
        if (pose.depth) depths.handles[id].depth = pose.depth;
    }
    part.poses = {std::move(depths)};
    return to_json(part);
}

using Clock = std::chrono::steady_clock;

// While the solver waits for a factor there is nothing to do.
constexpr auto pause = std::chrono::milliseconds(1);
// A picture that goes elsewhere by less is the same to the eye.
constexpr double seen_px = 0.5;

}  // namespace

std::shared_ptr<const Shape> ShapeMaker::make(const ShapeRequest& request, Progress& progress) {
    auto shape = std::make_shared<Shape>();
    shape->revision = request.revision;
    shape->live = request.live;
    try {
        update_subject(*request.puppet, progress);
        shape->subject = subject_;
        update_mesh(*request.puppet, progress);
        shape->mesh = mesh_;
        shape->moved = mesh_->V;
        deform(request, *shape, progress);
        shape->order = order(request);
        if (background_of(*request.puppet).kind == Background::Kind::inpaint) fill_subject(progress);
        shape->subject = subject_;
    } catch (const Error& error) {
        shape->error = error.what();
    } catch (const Cancelled&) {
        throw;
    } catch (const std::exception& error) {
        shape->error = MachineFault("puppetwarp", error.what()).what();
    }
    return shape;
}

void ShapeMaker::update_subject(const Puppet& puppet, Progress& progress) {
    std::string key = subject_key(puppet);
    if (subject_ && key == subject_key_) return;
    auto subject = std::make_shared<Subject>();
    progress.step("read", 0);
    subject->image = load_image(puppet);
    progress.step("cutout", 0);
    subject->cutout = cut_out_subject(puppet, subject->image);
    const Image visible = cut_subject(subject->image, subject->cutout, background_of(puppet));
    subject->shown_subject = shown_picture(visible, longest_side_px_);
    const bool same = visible.pixels.data == subject->image.pixels.data;
    subject->shown_picture = same ? subject->shown_subject : shown_picture(subject->image, longest_side_px_);
    // All of it or none: what was there before must still fit its key when something above has thrown.
    subject_ = std::move(subject);
    subject_key_ = std::move(key);
    mesh_.reset();
    stiffness_key_.clear();
}

// What is behind the subject takes a second, and only few ask for it.
void ShapeMaker::fill_subject(Progress& progress) {
    if (!subject_->shown_filled.empty()) return;
    auto subject = std::make_shared<Subject>(*subject_);
    subject->shown_filled = shown_picture(fill_behind(subject->image, subject->cutout, progress), longest_side_px_);
    subject_ = std::move(subject);
}

void ShapeMaker::update_mesh(const Puppet& puppet, Progress& progress) {
    std::string key = mesh_key(puppet);
    if (mesh_ && key == mesh_key_) return;
    mesh_.reset();
    solver_.reset();
    order_key_.clear();
    progress.step("triangulate", 0);
    const Outline outline =
        outline_subject(puppet, subject_->image.width(), subject_->image.height(), subject_->cutout);
    mesh_ = std::make_shared<const TriangleMesh>(mesh_subject(puppet, outline));
    mesh_key_ = std::move(key);
    last_moved_ = mesh_->V;
}

// Pictures of stiffness are read again only when the stiffness changes.
Rig ShapeMaker::rig(const Puppet& puppet) {
    Puppet part;
    part.rig.stiffness = puppet.rig.stiffness;
    const std::string key = puppet.folder.string() + to_json(part);
    if (key != stiffness_key_) {
        part.folder = puppet.folder;
        stiffness_ = load_rig(part, subject_->image.width(), subject_->image.height()).stiffness;
        stiffness_key_ = key;
    }
    Rig rig = puppet.rig;
    rig.stiffness = stiffness_;
    return rig;
}

// One solver as long as mesh and method stay, so that a change of the handles does not stall.
void ShapeMaker::update_solver(const Puppet& puppet, Progress& progress) {
    std::string method = method_key(puppet);
    std::string handles = rig_key(puppet);
    if (solver_ && method == method_key_ && handles == rig_key_) return;
    progress.step("bind", 0);
    if (solver_ && method == method_key_) {
        solver_->set_rig(rig(puppet), progress);
    } else {
        solver_ =
            std::make_unique<InteractiveSolver>(puppet.method, *mesh_, rig(puppet), pace_.metric_worker, progress);
        begun_ = false;
    }
    method_key_ = std::move(method);
    rig_key_ = std::move(handles);
}

void ShapeMaker::deform(const ShapeRequest& request, Shape& shape, Progress& progress) {
    if (request.puppet->rig.handles.empty()) {
        solver_.reset();
        last_moved_ = mesh_->V;
        return;
    }
    // Until this one is there, and if it cannot be made, the last one is the best there is.
    shape.moved = last_moved_;
    update_solver(*request.puppet, progress);
    progress.step("deform", 0);
    const auto before = Clock::now();
    InteractiveFrame frame = follow(request, shape, progress);
    const std::chrono::duration<double, std::milli> took = Clock::now() - before;
    if (!frame.V.allFinite()) {
        throw InvalidInput("mesh", "its triangles are too thin or too different in size to compute with",
                           "use a mesh with better triangles");
    }
    shape.deform_ms = took.count();
    shape.converged = frame.converged;
    shape.distortion = measure_distortion(*mesh_, frame.V);
    shape.warnings.insert(shape.warnings.end(), frame.warnings.begin(), frame.warnings.end());
    shape.moved = std::move(frame.V);
    last_moved_ = shape.moved;
}

const Eigen::VectorXi& ShapeMaker::order(const ShapeRequest& request) {
    std::string key = order_key(request);
    if (key == order_key_) return order_;
    const Eigen::VectorXd depth = vertex_depths(*mesh_, request.puppet->rig, request.pose);
    order_ = depth.size() > 0 ? painters_order(*mesh_, depth) : Eigen::VectorXi();
    order_key_ = std::move(key);
    return order_;
}

InteractiveFrame ShapeMaker::follow(const ShapeRequest& request, Shape& shape, Progress& progress) {
    // A new solver knows nothing of what is shown: it begins with what the command renders.
    if (!begun_ || !(request.live || request.keep_way)) {
        InteractiveFrame frame = solver_->restart(request.pose, progress);
        begun_ = true;
        return frame;
    }
    if (!request.live) return settle(request, shape, progress);
    if (request.revision != live_revision_) resting_since_ = Clock::now();
    live_revision_ = request.revision;
    InteractiveFrame frame = advance(request.pose);
    shape.turns = solver_->turns();
    shape.more = !frame.converged && Clock::now() - resting_since_ < pace_.patience;
    return frame;
}

InteractiveFrame ShapeMaker::advance(const Pose& pose) {
    InteractiveFrame frame = solver_->advance(pose, pace_.live_budget_ms);
    if (!frame.converged && frame.iterations == 0) std::this_thread::sleep_for(pause);
    return frame;
}

// Goes to the end of the drag, and then the way that the command will go: what the file says counts.
InteractiveFrame ShapeMaker::settle(const ShapeRequest& request, Shape& shape, Progress& progress) {
    const auto end = Clock::now() + pace_.patience;
    InteractiveFrame dragged;
    do {
        progress.step("deform", 0);
        dragged = advance(request.pose);
    } while (!dragged.converged && Clock::now() < end);
    shape.moved = last_moved_ = dragged.V;
    const auto jump_px = [&](const InteractiveFrame& frame) {
        return (frame.V - dragged.V).rowwise().norm().maxCoeff();
    };
    shape.turns = solver_->turns();
    InteractiveFrame filed = solver_->restart(with_turns(request.pose, shape.turns), progress);
    shape.jump_px = jump_px(filed);
    if (shape.jump_px <= seen_px) return filed;

    // Turns that do not lead to where the drag came from them are not worth keeping when it goes as well without.
    std::map<std::string, double> none = shape.turns;
    for (auto& [id, turn_rad] : none) turn_rad = 0;
    InteractiveFrame plain = solver_->restart(with_turns(request.pose, none), progress);
    if (jump_px(plain) <= shape.jump_px) {
        shape.turns = std::move(none);
        shape.jump_px = jump_px(plain);
        filed = std::move(plain);
    } else {
        filed = solver_->restart(with_turns(request.pose, shape.turns), progress);
    }
    if (shape.jump_px > seen_px)
        shape.warnings.push_back("the file cannot keep the way of this drag, so what it renders is shown");
    return filed;
}

}  // namespace puppetwarp::ui
