#include "model/shape_maker.h"

#include "model/shown_picture.h"

#include <puppetwarp/base/errors.h>
#include <puppetwarp/project/pipeline.h>
#include <puppetwarp/project/stiffness_pictures.h>

#include <algorithm>
#include <chrono>
#include <exception>

namespace puppetwarp::ui {

namespace {

// The parts of a puppet that a stage depends on, as text: two equal texts ask for the same.
std::string subject_key(const Puppet& puppet) {
    Puppet part;
    part.image = resolve(puppet, puppet.image).string();
    part.cutout = puppet.cutout;
    if (!part.cutout.path.empty()) part.cutout.path = resolve(puppet, puppet.cutout.path).string();
    return to_json(part);
}

std::string mesh_key(const Puppet& puppet) {
    Puppet part;
    part.mesh = puppet.mesh;
    for (const Handle& handle : puppet.rig.handles) {
        const bool edges =
            std::holds_alternative<BoneHandle>(handle.shape) || std::holds_alternative<CageHandle>(handle.shape);
        if (edges) part.rig.handles.push_back(handle);
    }
    return to_json(part);
}

std::string deformer_key(const Puppet& puppet) {
    Puppet part;
    part.rig = puppet.rig;
    part.method = puppet.method;
    return to_json(part);
}

// While a pin moves, a shape that is good to the eye now beats one that is good to the last digit later.
MethodOptions live_options(MethodOptions options) {
    options.tolerance = std::max(options.tolerance, 1e-4);
    options.max_iterations = std::min(options.max_iterations, 20);
    return options;
}

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
    const Image visible = apply_cutout(subject->image, subject->cutout);
    subject->shown_subject = shown_picture(visible, longest_side_px_);
    const bool same = visible.pixels.data == subject->image.pixels.data;
    subject->shown_picture = same ? subject->shown_subject : shown_picture(subject->image, longest_side_px_);
    // All of it or none: what was there before must still fit its key when something above has thrown.
    subject_ = std::move(subject);
    subject_key_ = std::move(key);
    mesh_.reset();
    stiffness_key_.clear();
}

void ShapeMaker::update_mesh(const Puppet& puppet, Progress& progress) {
    std::string key = mesh_key(puppet);
    if (mesh_ && key == mesh_key_) return;
    mesh_.reset();
    exact_ = {};
    live_ = {};
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

const Deformer& ShapeMaker::prepared(const Puppet& puppet, bool live, Progress& progress) {
    Prepared& kept = live ? live_ : exact_;
    std::string key = deformer_key(puppet);
    if (!kept.deformer || kept.key != key) {
        kept = {};
        progress.step("bind", 0);
        kept.deformer = make_deformer(live ? live_options(puppet.method) : puppet.method, *mesh_, rig(puppet));
        kept.key = std::move(key);
    }
    return *kept.deformer;
}

void ShapeMaker::deform(const ShapeRequest& request, Shape& shape, Progress& progress) {
    if (request.puppet->rig.handles.empty()) {
        last_moved_ = mesh_->V;
        return;
    }
    // Until this one is there, and if it cannot be made, the last one is the best there is.
    shape.moved = last_moved_;
    const Deformer& deformer = prepared(*request.puppet, request.live, progress);
    progress.step("deform", 0);
    const auto before = std::chrono::steady_clock::now();
    Deformation deformation = deformer.deform(request.pose, request.live ? &last_moved_ : nullptr, progress);
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - before;
    shape.deform_ms = took.count();
    shape.converged = deformation.converged;
    shape.distortion = measure_distortion(*mesh_, deformation.V);
    shape.moved = std::move(deformation.V);
    last_moved_ = shape.moved;
}

}  // namespace puppetwarp::ui
