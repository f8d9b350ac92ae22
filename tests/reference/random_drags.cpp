#include "reference/random_drags.h"

#include "reference/test_meshes.h"

#include <puppetwarp/base/errors.h>
#include <puppetwarp/mesh/distortion.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace puppetwarp::reference {

namespace {

constexpr int drags_a_subject = 25;

// Where a handle rests.
Point rest_of(const Handle& handle, const TriangleMesh& mesh) {
    if (const auto* point = std::get_if<PointHandle>(&handle.shape)) return point->at;
    if (const auto* vertex = std::get_if<VertexHandle>(&handle.shape)) return mesh.V.row(vertex->index).transpose();
    const Polyline& corners = std::get<RegionHandle>(handle.shape).points;
    return (corners[0] + corners[2]) / 2;
}

}  // namespace

RandomDrags::RandomDrags(const MethodOptions& options, std::uint32_t seed, int most_vertices, bool worker)
    : options_(options), most_vertices_(most_vertices), worker_(worker), random_(seed), seed_(seed) {}

double RandomDrags::uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(random_()) / 4294967296.0);
}

int RandomDrags::below(int count) {
    return static_cast<int>(random_() % static_cast<std::uint32_t>(count));
}

// Somewhere in the subject.
Point RandomDrags::place() {
    const int t = below(static_cast<int>(mesh_.F.rows()));
    return (mesh_.V.row(mesh_.F(t, 0)) + mesh_.V.row(mesh_.F(t, 1)) + mesh_.V.row(mesh_.F(t, 2))).transpose() / 3;
}

Handle RandomDrags::handle() {
    std::string id = "h" + std::to_string(made_++);
    const int kind = below(10);
    if (kind == 0) return {std::move(id), VertexHandle{below(static_cast<int>(mesh_.V.rows()))}};
    const Point at = place();
    if (kind > 1) return {std::move(id), PointHandle{at, {}}};
    const double reach = uniform(0.03, 0.1) * size_;
    return {std::move(id), RegionHandle{{at + Point(-reach, -reach), at + Point(reach, -reach),
                                         at + Point(reach, reach), at + Point(-reach, reach)},
                                        Falloff::none}};
}

void RandomDrags::choose_subject() {
    seed_ = static_cast<std::uint32_t>(random_());
    random_.seed(seed_);
    const double vertices = 100 * std::pow(most_vertices_ / 100.0, uniform(0, 1));
    const double area = 1000.0 * 1000.0;
    switch (below(4)) {
        case 0: mesh_ = figure(1000, std::sqrt(0.23 * area / vertices * 1.15)); break;
        case 1: mesh_ = blob(1000, std::sqrt(0.32 * area / vertices * 1.15), seed_); break;
        case 2: {
            const int rings = std::max(2, static_cast<int>(std::sqrt(vertices / 10)));
            mesh_ = annulus(rings, static_cast<int>(vertices) / rings, uniform(100, 400), 500);
            break;
        }
        default: {
            const int rows = std::max(3, static_cast<int>(std::sqrt(vertices / uniform(1, 10))));
            mesh_ = grid(static_cast<int>(vertices) / rows, rows, 1000, 1000.0 * rows * rows / vertices, 0.25, seed_);
        }
    }
    size_ = bounding_diagonal(mesh_.V);
    rig_ = {};
    pose_ = {};
    const int handles = 1 + below(7);
    for (int h = 0; h < handles; ++h) rig_.handles.push_back(handle());
    solver_.reset();
    solver_ = std::make_unique<InteractiveSolver>(options_, mesh_, rig_, worker_);
    last_ = mesh_.V;
    left_ = drags_a_subject;
}

// A handle more or less while everything stays where it is.
void RandomDrags::change_rig() {
    Rig rig = rig_;
    Pose pose = pose_;
    if (rig.handles.size() > 1 && below(2) == 0) {
        const auto gone = rig.handles.begin() + below(static_cast<int>(rig.handles.size()));
        pose.handles.erase(gone->id);
        rig.handles.erase(gone);
    } else {
        rig.handles.push_back(handle());
    }
    solver_->set_rig(rig);
    rig_ = std::move(rig);
    pose_ = std::move(pose);
}

HandlePose RandomDrags::target(const Handle& handle) {
    HandlePose target;
    const double reach = size_ * std::pow(10.0, uniform(-3, below(8) == 0 ? 1.5 : 0));
    const double angle = uniform(-std::numbers::pi, std::numbers::pi);
    const Point move = reach * Point(std::cos(angle), std::sin(angle));
    const auto now = pose_.handles.find(handle.id);
    const bool onward = below(2) == 0 && now != pose_.handles.end() && now->second.to;
    target.to = (onward ? *now->second.to : rest_of(handle, mesh_)) + move;
    if (std::holds_alternative<VertexHandle>(handle.shape)) return target;
    if (below(4) == 0) target.rotate_rad = uniform(-4, 4);
    if (below(6) == 0) target.scale = std::exp(uniform(-2, 2));
    return target;
}

// One handle or two moved, two in each other's places, or all to one place.
Pose RandomDrags::aim() {
    Pose pose = pose_;
    const int count = static_cast<int>(rig_.handles.size());
    const auto any = [&]() -> const Handle& { return rig_.handles[static_cast<std::size_t>(below(count))]; };
    const int kind = below(12);
    if (kind == 0) {
        const Handle &a = any(), &b = any();
        pose.handles[a.id].to = rest_of(b, mesh_);
        pose.handles[b.id].to = rest_of(a, mesh_);
    } else if (kind == 1) {
        const Point to = place();
        for (const Handle& handle : rig_.handles) pose.handles[handle.id].to = to;
    } else {
        for (int n = 1 + below(2); n > 0; --n) {
            const Handle& handle = any();
            pose.handles[handle.id] = target(handle);
        }
    }
    return pose;
}

void RandomDrags::judge(const Eigen::MatrixX2d& V) {
    ++tally_.calls;
    const bool finite = V.allFinite();
    const bool folded = measure_distortion(mesh_, V).flipped_triangles > 0;
    tally_.not_finite += finite ? 0 : 1;
    tally_.folds += folded ? 1 : 0;
    if (folded || !finite) tally_.worst_at = seed_;
}

// What is refused changes nothing.
void RandomDrags::guarded(const std::function<void()>& work) {
    try {
        work();
    } catch (const InvalidInput&) {
        ++tally_.refused;
    }
}

void RandomDrags::deform_at_once(const Pose& pose) {
    Progress progress;
    const std::unique_ptr<Deformer> deformer = make_deformer(options_, mesh_, rig_);
    const Deformation from_rest = deformer->deform(pose, nullptr, progress);
    judge(from_rest.V);
    judge(deformer->deform(pose, &last_, progress).V);
    for (std::size_t k = 1; k < from_rest.energy_history.size(); ++k) {
        const double before = from_rest.energy_history[k - 1];
        tally_.worst_rise = std::max(tally_.worst_rise, (from_rest.energy_history[k] - before) / before);
    }
}

void RandomDrags::drag() {
    ++tally_.drags;
    while (left_ == 0) guarded([this] { choose_subject(); });
    --left_;
    if (below(6) == 0) guarded([this] { change_rig(); });
    const Pose target = aim();
    const int frames = 1 + below(4), resting = below(6);
    bool there = false;
    double energy = 0;
    for (int frame = 1; frame <= frames + resting; ++frame) {
        Pose here = target;
        for (auto& [id, to] : here.handles) {
            const auto from = pose_.handles.find(id);
            const Point start = from != pose_.handles.end() && from->second.to ? *from->second.to
                                                                               : rest_of(*find_handle(rig_, id), mesh_);
            const double share = std::min(1.0, static_cast<double>(frame) / frames);
            if (to.to) to.to = start + share * (*to.to - start);
        }
        guarded([&] {
            const InteractiveFrame now = solver_->advance(here, below(20) == 0 ? 30 : 0);
            judge(now.V);
            last_ = now.V;
            if (there) tally_.worst_rise = std::max(tally_.worst_rise, (now.energy - energy) / (energy + 1e-9));
            there = frame >= frames && now.settled;
            energy = now.energy;
            if (frame == frames) pose_ = target;
        });
    }
    if (below(40) == 0) {
        guarded([&] { deform_at_once(target); });
    } else if (below(60) == 0) {
        Progress progress;
        guarded([&] { judge(solver_->restart(target, progress).V); });
    }
}

}  // namespace puppetwarp::reference
