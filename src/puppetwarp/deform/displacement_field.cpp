#include <puppetwarp/deform/displacement_field.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/deform/falloff.h>
#include <puppetwarp/rig/disc_holder.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace puppetwarp {

namespace {

using Complex = std::complex<double>;

// Handles whose targets are missed by more than this share of the subject's size contradict each other.
constexpr double contradiction = 1e-6;

std::vector<bool> held_mask(const HeldVertices& vertices, Eigen::Index count) {
    std::vector<bool> held(static_cast<std::size_t>(count));
    for (const HeldVertex& each : vertices.vertices) held[static_cast<std::size_t>(each.vertex)] = true;
    return held;
}

// The vertices that are held, by the place of their handle among those that hold any: handles that hold none may come
// and go.
HeldVertices held_vertices(const Rig& rig, const Binding& binding) {
    HeldVertices held;
    for (const HeldVertex& each : binding.vertices) held.handles.push_back(each.handle);
    std::sort(held.handles.begin(), held.handles.end());
    held.handles.erase(std::unique(held.handles.begin(), held.handles.end()), held.handles.end());
    for (const HeldVertex& each : binding.vertices) {
        const auto at = std::lower_bound(held.handles.begin(), held.handles.end(), each.handle);
        held.vertices.push_back({static_cast<int>(at - held.handles.begin()), each.vertex});
    }
    for (const int h : held.handles) {
        const Handle& handle = rig.handles[static_cast<std::size_t>(h)];
        held.region.push_back(std::holds_alternative<RegionHandle>(handle.shape));
        held.still.push_back(has_falloff(handle));
    }
    return held;
}

bool same_vertices(const HeldVertices& a, const HeldVertices& b) {
    const auto same = [](const HeldVertex& x, const HeldVertex& y) {
        return x.handle == y.handle && x.vertex == y.vertex;
    };
    return std::equal(a.vertices.begin(), a.vertices.end(), b.vertices.begin(), b.vertices.end(), same) &&
           a.region == b.region && a.still == b.still;
}

std::vector<int> falloff_handles(const Rig& rig) {
    std::vector<int> handles;
    for (std::size_t h = 0; h < rig.handles.size(); ++h) {
        if (has_falloff(rig.handles[h])) handles.push_back(static_cast<int>(h));
    }
    return handles;
}

std::vector<FieldGoal> goals_of(const Targets& targets) {
    std::vector<FieldGoal> goals;
    for (const HoldTarget& target : targets.holds) {
        FieldGoal goal;
        goal.mean = target.move;
        if (target.rotate_rad) {
            goal.turn = std::polar(target.scale.value_or(1), *target.rotate_rad);
        } else {
            goal.scale = target.scale;
        }
        goal.shear = target.shear;
        goals.push_back(goal);
    }
    return goals;
}

}  // namespace

struct DisplacementField::Prepared {
    Prepared(Method method_, const EnergyOf& energy_of, const TriangleMesh& mesh_, const Rig& rig)
        : method(method_),
          mesh(mesh_),
          discs(mesh),
          vertices(held_vertices(rig, bind(rig))),
          rest(complex_positions(mesh.V)),
          size(bounding_diagonal(mesh.V)),
          component(vertex_components(mesh)),
          stiffness(triangle_stiffness(mesh, rig.stiffness)),
          held(held_mask(vertices, mesh.V.rows())),
          energy(energy_of(mesh, stiffness)),
          inverse(make_field_inverse(energy, component, held)),
          held_field(inverse, rest, vertices) {}

    Binding bind(const Rig& rig) const { return take_hold(discs, mesh, rig, method_name(method)); }

    Method method;
    TriangleMesh mesh;
    DiscHolder discs;
    HeldVertices vertices;
    Eigen::VectorXcd rest;
    double size;
    Eigen::VectorXi component;
    Eigen::VectorXd stiffness;
    std::vector<bool> held;
    FieldEnergy energy;
    std::shared_ptr<const FieldInverse> inverse;
    HeldField held_field;
};

DisplacementField::DisplacementField(Method method, const EnergyOf& energy, const TriangleMesh& mesh, const Rig& rig)
    : DisplacementField(std::make_shared<const Prepared>(method, energy, mesh, rig), rig, nullptr) {}

DisplacementField::DisplacementField(std::shared_ptr<const Prepared> prepared, const Rig& rig,
                                     const DisplacementField* known)
    : prepared_(std::move(prepared)),
      rig_(rig),
      binding_(prepared_->bind(rig)),
      held_handles_(held_vertices(rig_, binding_).handles),
      falloff_handles_(falloff_handles(rig_)),
      falloff_(falloff_weights(prepared_->mesh, rig_, binding_, prepared_->stiffness)),
      responses_(prepared_->inverse, prepared_->component, prepared_->held, binding_.holds,
                 known != nullptr ? &known->responses_ : nullptr) {}

std::unique_ptr<Deformer> DisplacementField::with_rig(const Rig& rig) const {
    require_sound(rig);
    const Eigen::VectorXd stiffness = triangle_stiffness(prepared_->mesh, rig.stiffness);
    if (stiffness.size() != prepared_->stiffness.size() || stiffness != prepared_->stiffness) return nullptr;
    const bool hold_vertices = std::any_of(rig.handles.begin(), rig.handles.end(), [](const Handle& handle) {
        return std::holds_alternative<RegionHandle>(handle.shape) || std::holds_alternative<VertexHandle>(handle.shape);
    });
    if (hold_vertices || !prepared_->vertices.vertices.empty()) {
        if (!same_vertices(held_vertices(rig, prepared_->bind(rig)), prepared_->vertices)) return nullptr;
    }
    return std::unique_ptr<Deformer>(new DisplacementField(prepared_, rig, this));
}

// By the regions with a falloff alone. #V
Eigen::VectorXcd DisplacementField::falloff_displacement(const Targets& targets) const {
    const Eigen::VectorXcd& rest = prepared_->rest;
    Eigen::VectorXcd u = Eigen::VectorXcd::Zero(rest.size());
    for (std::size_t j = 0; j < falloff_handles_.size(); ++j) {
        const AffineMap& map = targets.maps[static_cast<std::size_t>(falloff_handles_[j])];
        const auto weight = falloff_.col(static_cast<Eigen::Index>(j));
        for (Eigen::Index v = 0; v < u.size(); ++v) u(v) += weight(v) * (map(rest(v)) - rest(v));
    }
    return u;
}

// A move that all share is taken away before the solve, and costs no digits then.
Complex DisplacementField::common_move(const Targets& targets) const {
    if (!falloff_handles_.empty()) return 0;
    if (!targets.holds.empty()) return targets.holds.front().move;
    return targets.vertices(0) - prepared_->rest(binding_.vertices.front().vertex);
}

Deformation DisplacementField::deform(const Pose& pose, const Eigen::MatrixX2d*, Progress& progress) const {
    progress.step("deform", 0);
    const Targets targets =
        resolve(binding_, prepared_->mesh, rig_, pose, AffineUse::yes, method_name(prepared_->method));
    const Eigen::VectorXcd& rest = prepared_->rest;
    Eigen::VectorXcd held_moves(targets.vertices.size());
    for (std::size_t i = 0; i < binding_.vertices.size(); ++i) {
        const auto row = static_cast<Eigen::Index>(i);
        held_moves(row) = targets.vertices(row) - rest(binding_.vertices[i].vertex);
    }
    const Complex common = common_move(targets);
    std::vector<AffineMap> held_maps;
    for (const int h : held_handles_) held_maps.push_back(targets.maps[static_cast<std::size_t>(h)]);
    Eigen::VectorXcd u = falloff_displacement(targets) + prepared_->held_field(held_moves, held_maps, common);
    std::vector<FieldGoal> goals = goals_of(targets);
    for (FieldGoal& goal : goals) goal.mean -= common;
    responses_.bring_to(goals, u);

    Deformation result;
    result.max_handle_error_px = responses_.largest_error(goals, u);
    if (!(result.max_handle_error_px <= contradiction * prepared_->size)) {
        throw InvalidInput("pose '" + pose.name + "'",
                           "handles that are close together ask for what cannot be met together",
                           "move them apart, or remove one");
    }
    for (Eigen::Index v = 0; v < u.size(); ++v) {
        u(v) = binding_.loose[static_cast<std::size_t>(v)] ? 0 : u(v) + common;
    }
    for (std::size_t i = 0; i < binding_.vertices.size(); ++i) {
        u(binding_.vertices[i].vertex) = held_moves(static_cast<Eigen::Index>(i));
    }
    result.V = point_positions(rest + u);
    result.energy = prepared_->energy(u);
    result.energy_history = {result.energy};
    result.warnings = binding_.warnings;
    return result;
}

}  // namespace puppetwarp
