#include "field_problem.h"

#include <puppetwarp/rig/binding.h>

namespace puppetwarp::testing_fields {

std::unique_ptr<Deformer> made(Method method, const TriangleMesh& mesh, const Rig& rig) {
    MethodOptions options;
    options.method = method;
    return make_deformer(options, mesh, rig);
}

Deformation deformed(const MethodOptions& options, const TriangleMesh& mesh, const Rig& rig, const Pose& pose) {
    Progress progress;
    return make_deformer(options, mesh, rig)->deform(pose, nullptr, progress);
}

Deformation deformed(Method method, const TriangleMesh& mesh, const Rig& rig, const Pose& pose) {
    MethodOptions options;
    options.method = method;
    return deformed(options, mesh, rig, pose);
}

void hold_vertices(const std::vector<int>& vertices, const Eigen::RowVector2d& to, Rig& rig, Pose& pose) {
    for (const int v : vertices) {
        const std::string id = std::string("held").append(std::to_string(v));
        rig.handles.push_back({id, VertexHandle{v}});
        pose.handles[id].to = to.transpose();
    }
}

Eigen::MatrixX2d dense_answer(const reference::DenseEnergy& energy, const TriangleMesh& mesh, const Rig& rig,
                              const Pose& pose) {
    const Binding binding = take_hold(mesh, rig, "test");
    const Targets targets = resolve(binding, mesh, rig, pose, AffineUse::yes, "test");
    const Eigen::VectorXcd rest = complex_positions(mesh.V);
    std::vector<reference::DenseConstraint> constraints;
    for (std::size_t i = 0; i < binding.vertices.size(); ++i) {
        const int v = binding.vertices[i].vertex;
        constraints.push_back({{{v, 1.0}}, targets.vertices(static_cast<Eigen::Index>(i)) - rest(v)});
    }
    for (std::size_t i = 0; i < binding.holds.size(); ++i) {
        const Hold& hold = binding.holds[i];
        const HoldTarget& target = targets.holds[i];
        constraints.push_back({hold.mean, target.move});
        if (target.rotate_rad) {
            constraints.push_back({hold.turn, std::polar(target.scale.value_or(1), *target.rotate_rad) - 1.0});
        }
        if (target.shear) constraints.push_back({hold.shear, *target.shear});
    }
    return point_positions(rest + reference::dense_field(mesh, energy, constraints));
}

}  // namespace puppetwarp::testing_fields
