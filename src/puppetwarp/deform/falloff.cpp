#include <puppetwarp/deform/falloff.h>

#include <puppetwarp/deform/field_inverse.h>
#include <puppetwarp/mesh/geodesic_distance.h>

#include <algorithm>
#include <cmath>

namespace puppetwarp {

namespace {

Falloff falloff_of(const Handle& handle) {
    const auto* region = std::get_if<RegionHandle>(&handle.shape);
    return region == nullptr ? Falloff::none : region->falloff;
}

// Which vertices each region with a falloff holds, in the order of the rig; last, all that the others hold.
std::vector<std::vector<int>> held_sets(const Rig& rig, const Binding& binding) {
    std::vector<std::size_t> set_of(rig.handles.size());
    std::size_t regions = 0;
    for (const Handle& handle : rig.handles) regions += has_falloff(handle) ? 1 : 0;
    std::size_t next = 0;
    for (std::size_t h = 0; h < rig.handles.size(); ++h) set_of[h] = has_falloff(rig.handles[h]) ? next++ : regions;
    std::vector<std::vector<int>> sets(regions + 1);
    for (const HeldVertex& held : binding.vertices) {
        sets[set_of[static_cast<std::size_t>(held.handle)]].push_back(held.vertex);
    }
    std::vector<bool> taken(binding.loose.size());
    for (const HeldVertex& held : binding.vertices) taken[static_cast<std::size_t>(held.vertex)] = true;
    for (const Hold& hold : binding.holds) {
        for (const auto& entry : hold.mean) {
            const auto v = static_cast<std::size_t>(entry.first);
            if (!taken[v]) sets.back().push_back(entry.first);
            taken[v] = true;
        }
    }
    return sets;
}

Eigen::MatrixXd harmonic_weights(const TriangleMesh& mesh, const std::vector<std::vector<int>>& sets,
                                 const Eigen::VectorXd& stiffness) {
    const auto regions = static_cast<Eigen::Index>(sets.size()) - 1;
    std::vector<bool> held(static_cast<std::size_t>(mesh.V.rows()));
    Eigen::MatrixXd values = Eigen::MatrixXd::Zero(mesh.V.rows(), regions);
    for (std::size_t j = 0; j < sets.size(); ++j) {
        for (const int v : sets[j]) {
            held[static_cast<std::size_t>(v)] = true;
            if (j + 1 < sets.size()) values(v, static_cast<Eigen::Index>(j)) = 1;
        }
    }
    FieldEnergy energy;
    energy.L = cotangent_stiffness(mesh, stiffness);
    energy.M = lumped_mass(mesh);
    return make_field_inverse(energy, vertex_components(mesh), held)->extend(values);
}

Eigen::MatrixXd geodesic_weights(const TriangleMesh& mesh, const std::vector<std::vector<int>>& sets) {
    Eigen::MatrixXd distance(mesh.V.rows(), static_cast<Eigen::Index>(sets.size()));
    for (std::size_t j = 0; j < sets.size(); ++j) {
        distance.col(static_cast<Eigen::Index>(j)) = geodesic_distance(mesh, sets[j]);
    }
    Eigen::MatrixXd weights = Eigen::MatrixXd::Zero(mesh.V.rows(), distance.cols() - 1);
    for (Eigen::Index v = 0; v < mesh.V.rows(); ++v) {
        // As shares of the nearest, so that neither 0 nor infinity is divided by.
        const double nearest = distance.row(v).minCoeff();
        if (!std::isfinite(nearest)) continue;
        const auto closeness = [&](double d) { return d <= nearest ? 1.0 : (nearest / d) * (nearest / d); };
        double sum = 0;
        for (Eigen::Index j = 0; j < distance.cols(); ++j) sum += closeness(distance(v, j));
        for (Eigen::Index j = 0; j < weights.cols(); ++j) weights(v, j) = closeness(distance(v, j)) / sum;
    }
    return weights;
}

}  // namespace

bool has_falloff(const Handle& handle) {
    return falloff_of(handle) != Falloff::none;
}

Eigen::MatrixXd falloff_weights(const TriangleMesh& mesh, const Rig& rig, const Binding& binding,
                                const Eigen::VectorXd& stiffness) {
    std::vector<Falloff> kinds;
    for (const Handle& handle : rig.handles) {
        if (has_falloff(handle)) kinds.push_back(falloff_of(handle));
    }
    Eigen::MatrixXd weights(mesh.V.rows(), static_cast<Eigen::Index>(kinds.size()));
    if (kinds.empty()) return weights;
    const auto sets = held_sets(rig, binding);
    for (const Falloff kind : {Falloff::harmonic, Falloff::geodesic}) {
        if (std::find(kinds.begin(), kinds.end(), kind) == kinds.end()) continue;
        const Eigen::MatrixXd all =
            kind == Falloff::harmonic ? harmonic_weights(mesh, sets, stiffness) : geodesic_weights(mesh, sets);
        for (std::size_t j = 0; j < kinds.size(); ++j) {
            const auto column = static_cast<Eigen::Index>(j);
            if (kinds[j] == kind) weights.col(column) = all.col(column);
        }
    }
    return weights;
}

}  // namespace puppetwarp
