#include <puppetwarp/weights/cage_coordinates.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/weights/cage_checks.h>
#include <puppetwarp/weights/cauchy.h>
#include <puppetwarp/weights/mean_value.h>
#include <puppetwarp/weights/weight_problem.h>

namespace puppetwarp {

namespace {

const Polyline& only_cage(const Rig& rig, WeightKind kind) {
    const auto* cage = std::get_if<CageHandle>(&rig.handles.front().shape);
    if (cage != nullptr && rig.handles.size() == 1) return cage->points;
    throw InvalidInput("weights '" + weight_kind_name(kind) + "'",
                       "are a formula of one cage; the rig has " +
                           std::string(cage == nullptr ? "other handles" : "more handles than that"),
                       "use bbw, harmonic or, beside a cage, harmonic-cage");
}

std::string outside_text(Eigen::Index outside, Eigen::Index all, const std::string& id) {
    return std::to_string(outside) + " of " + std::to_string(all) + " vertices lie outside the cage '" + id +
           "' and follow its nearest edge";
}

}  // namespace

bool is_closed_form(WeightKind kind) {
    return kind == WeightKind::mean_value || kind == WeightKind::green || kind == WeightKind::cauchy;
}

Weights cage_coordinates(const TriangleMesh& mesh, const Rig& rig, WeightKind kind) {
    const Polyline& cage = only_cage(rig, kind);
    require_sound_cages(mesh, rig);
    Weights weights;
    weights.columns = weight_columns(rig);
    if (kind == WeightKind::mean_value) {
        weights.W = mean_value_coordinates(mesh.V, cage);
        return weights;
    }
    const CauchyCoordinates found = cauchy_coordinates(mesh.V, cage);
    weights.W = found.C.real();
    weights.W_imaginary = found.C.imag();
    if (found.outside > 0) {
        weights.warnings.push_back(outside_text(found.outside, mesh.V.rows(), rig.handles.front().id));
    }
    return weights;
}

}  // namespace puppetwarp
