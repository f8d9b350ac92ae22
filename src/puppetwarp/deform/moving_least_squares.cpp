#include <puppetwarp/deform/moving_least_squares.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace puppetwarp {

namespace {

using Complex = std::complex<double>;

// Handles that lie within this share of the subject's size of a line are on it: an affine map across it says nothing.
constexpr double on_line = 1e-6;

Complex complex_of(const Point& p) {
    return {p.x(), p.y()};
}

}  // namespace

MovingLeastSquaresDeformer::MovingLeastSquaresDeformer(Method method, const TriangleMesh& mesh, const Rig& rig)
    : method_(method),
      mesh_(mesh),
      rig_(rig),
      rest_(complex_positions(mesh.V)),
      size_(bounding_diagonal(mesh.V)),
      binding_(take_hold(mesh, rig, method_name(method))),
      control_(static_cast<std::size_t>(rest_.size()), -1) {
    collect(rig);
    classify();
    for (const HeldVertex& held : binding_.vertices) control_[static_cast<std::size_t>(held.vertex)] = held.handle;
    for (Eigen::Index v = 0; v < rest_.size(); ++v) {
        int& control = control_[static_cast<std::size_t>(v)];
        if (control < 0) control = control_at(rest_(v));
        for (const Curve& curve : curves_) {
            moments_.push_back(control < 0 ? moments(curve, rest_(v)) : MlsMoments());
        }
    }
}

void MovingLeastSquaresDeformer::collect(const Rig& rig) {
    for (std::size_t h = 0; h < rig.handles.size(); ++h) {
        const auto& shape = rig.handles[h].shape;
        const auto handle = static_cast<int>(h);
        if (const auto* point = std::get_if<PointHandle>(&shape)) {
            add_disc(handle, complex_of(point->at), point->radius_px.value_or(default_disc_share * size_));
        } else if (const auto* vertex = std::get_if<VertexHandle>(&shape)) {
            add_disc(handle, rest_(vertex->index), default_disc_share * size_);
        } else if (const auto* bone = std::get_if<BoneHandle>(&shape)) {
            curves_.push_back({handle, {complex_of(bone->from), complex_of(bone->to)}});
        } else if (const auto* region = std::get_if<RegionHandle>(&shape)) {
            Curve outline{handle, {}};
            for (const Point& p : region->points) {
                if (outline.points.empty() || complex_of(p) != outline.points.back()) {
                    outline.points.push_back(complex_of(p));
                }
            }
            if (outline.points.front() != outline.points.back()) outline.points.push_back(outline.points.front());
            curves_.push_back(outline);
        }
    }
}

void MovingLeastSquaresDeformer::add_disc(int handle, const Complex& at, double radius_px) {
    for (Disc& disc : discs_) {
        if (std::abs(disc.at - at) > one_vertex * size_) continue;
        disc.handles.push_back(handle);
        return;
    }
    discs_.push_back({{handle}, at, radius_px});
}

// Whether the handles lie in one place, or on one line.
void MovingLeastSquaresDeformer::classify() {
    std::vector<Complex> places;
    for (const Disc& disc : discs_) places.push_back(disc.at);
    for (const Curve& curve : curves_) places.insert(places.end(), curve.points.begin(), curve.points.end());
    const Complex first = places.front();
    const auto farther = [&](const Complex& a, const Complex& b) { return std::abs(a - first) < std::abs(b - first); };
    const Complex arm = *std::max_element(places.begin(), places.end(), farther) - first;
    one_place_ = std::abs(arm) <= one_place * size_;
    one_line_ = one_place_ || std::all_of(places.begin(), places.end(), [&](const Complex& p) {
                    return std::abs((std::conj(arm) * (p - first)).imag()) <= on_line * size_ * std::abs(arm);
                });
}

// The handle that lies at a place, or -1.
int MovingLeastSquaresDeformer::control_at(const Complex& v) const {
    const double near = one_vertex * size_;
    for (const Disc& disc : discs_) {
        if (std::abs(disc.at - v) <= near) return disc.handles.front();
    }
    for (const Curve& curve : curves_) {
        for (std::size_t i = 1; i < curve.points.size(); ++i) {
            if (segment_distance(v, curve.points[i - 1], curve.points[i]) <= near) return curve.handle;
        }
    }
    return -1;
}

MlsMoments MovingLeastSquaresDeformer::moments(const Curve& curve, const Complex& v) const {
    MlsMoments sum;
    for (std::size_t i = 1; i < curve.points.size(); ++i)
        sum += segment_moments(v, curve.points[i - 1], curve.points[i]);
    // Per length, as points have it per piece.
    const double pieces = 1 / (default_disc_share * size_);
    return {pieces * sum.weight, pieces * sum.first, pieces * sum.norm, pieces * sum.square};
}

// \param curves  moments of each curve seen from v.
MlsFit MovingLeastSquaresDeformer::fit_at(const Complex& v, const MlsMoments* curves, const std::vector<Moved>& moved,
                                          const Targets& targets) const {
    MlsFit fit;
    for (std::size_t d = 0; d < discs_.size(); ++d) {
        const MlsMoments moments = point_moments(v, discs_[d].at);
        fit.add(moments, moved[d].move);
        if (!moved[d].turned) continue;
        fit.add_turn(moments.weight * discs_[d].radius_px * discs_[d].radius_px, moved[d].turn, moved[d].shear);
    }
    for (std::size_t c = 0; c < curves_.size(); ++c) {
        const AffineMap& map = targets.maps[static_cast<std::size_t>(curves_[c].handle)];
        fit.add(curves[c], map.alpha - 1.0, map.beta, map(v) - v);
    }
    return fit;
}

// Where the field points at a disc without the disc's own turn: that of a fit about its place.
Complex MovingLeastSquaresDeformer::direction_at(std::size_t disc, const std::vector<Moved>& moved,
                                                 const Targets& targets) const {
    const Complex at = discs_[disc].at;
    Complex sum = 0;
    for (std::size_t d = 0; d < discs_.size(); ++d) {
        const Complex arm = discs_[d].at - at;
        if (std::abs(arm) <= one_place * size_) continue;
        sum += std::conj(arm) * (arm + moved[d].move - moved[disc].move) / std::norm(arm);
        if (moved[d].turned) {
            sum += discs_[d].radius_px * discs_[d].radius_px / std::norm(arm) * (1.0 + moved[d].turn);
        }
    }
    for (const Curve& curve : curves_) {
        const AffineMap& map = targets.maps[static_cast<std::size_t>(curve.handle)];
        bool through = false;
        for (std::size_t i = 1; i < curve.points.size(); ++i) {
            through |= segment_distance(at, curve.points[i - 1], curve.points[i]) <= one_vertex * size_;
        }
        if (through) return std::abs(map.alpha) > 0 ? map.alpha / std::abs(map.alpha) : Complex(1);
        const MlsMoments seen = moments(curve, at);
        const Complex move = map(at) - (at + moved[disc].move);
        sum += map.alpha * seen.norm + map.beta * std::conj(seen.square) + move * std::conj(seen.first);
    }
    return std::abs(sum) > 0 ? sum / std::abs(sum) : Complex(1);
}

const HandlePose* MovingLeastSquaresDeformer::pose_of(int handle, const Pose& pose) const {
    const auto found = pose.handles.find(rig_.handles[static_cast<std::size_t>(handle)].id);
    return found == pose.handles.end() ? nullptr : &found->second;
}

std::vector<MovingLeastSquaresDeformer::Moved> MovingLeastSquaresDeformer::moved_discs(const Targets& targets,
                                                                                       const Pose& pose) const {
    std::vector<Moved> moved;
    std::vector<std::pair<std::size_t, double>> scaled;
    for (std::size_t d = 0; d < discs_.size(); ++d) {
        Moved now;
        std::optional<double> scale;
        for (const int handle : discs_[d].handles) {
            const AffineMap& map = targets.maps[static_cast<std::size_t>(handle)];
            now.move = map(discs_[d].at) - discs_[d].at;
            const HandlePose* target = pose_of(handle, pose);
            if (target == nullptr) continue;
            if (target->to) now.move = complex_of(*target->to) - discs_[d].at;
            if (target->scale) scale = target->scale;
            if (!target->rotate_rad && !target->affine) continue;
            now.turned = true;
            now.turn = map.alpha - 1.0;
            now.shear = map.beta;
            if (method_ == Method::mls_rigid) now.turn = map.alpha / std::abs(map.alpha) - 1.0;
        }
        if (scale && !now.turned && method_ != Method::mls_rigid) scaled.emplace_back(d, *scale);
        moved.push_back(now);
    }
    // All from the field without scales, so that their order does not matter.
    std::vector<Complex> turns;
    turns.reserve(scaled.size());
    for (const auto& [d, scale] : scaled) turns.push_back(scale * direction_at(d, moved, targets));
    for (std::size_t i = 0; i < scaled.size(); ++i) {
        moved[scaled[i].first].turned = true;
        moved[scaled[i].first].turn = turns[i] - 1.0;
    }
    return moved;
}

// At points and the ends of bones, where no vertex need be.
double MovingLeastSquaresDeformer::largest_error(const std::vector<Moved>& moved, const Targets& targets,
                                                 MlsFit::Kind kind) const {
    double largest = 0;
    const auto compare = [&](const Complex& at, const Complex& goal) {
        const int control = control_at(at);
        Complex move;
        if (control >= 0) {
            move = targets.maps[static_cast<std::size_t>(control)](at) - at;
        } else {
            std::vector<MlsMoments> curves;
            curves.reserve(curves_.size());
            for (const Curve& curve : curves_) curves.push_back(moments(curve, at));
            move = fit_at(at, curves.data(), moved, targets).solve(kind).at_centre;
        }
        largest = std::max(largest, std::abs(move - goal));
    };
    for (std::size_t d = 0; d < discs_.size(); ++d) compare(discs_[d].at, moved[d].move);
    for (const Curve& curve : curves_) {
        const AffineMap& map = targets.maps[static_cast<std::size_t>(curve.handle)];
        for (const Complex& end : curve.points) compare(end, map(end) - end);
    }
    return largest;
}

std::vector<std::string> MovingLeastSquaresDeformer::warnings(const Pose& pose) const {
    std::vector<std::string> found = binding_.warnings;
    if (method_ != Method::mls_rigid) return found;
    for (const Handle& handle : rig_.handles) {
        const auto target = pose.handles.find(handle.id);
        if (target == pose.handles.end() || target->second.scale.value_or(1) == 1) continue;
        found.push_back("handle '" + handle.id + "': 'mls-rigid' cannot scale, its scale has no effect");
    }
    return found;
}

Deformation MovingLeastSquaresDeformer::deform(const Pose& pose, const Eigen::MatrixX2d*, Progress& progress) const {
    progress.step("deform", 0);
    const Targets targets = resolve(binding_, mesh_, rig_, pose, affine_use(), method_name(method_));
    const std::vector<Moved> moved = moved_discs(targets, pose);
    const bool turned = std::any_of(moved.begin(), moved.end(), [](const Moved& each) { return each.turned; });
    MlsFit::Kind kind = method_ == Method::mls_rigid        ? MlsFit::Kind::rigid
                        : method_ == Method::mls_similarity ? MlsFit::Kind::similarity
                                                            : MlsFit::Kind::affine;
    if (one_place_ && !turned) kind = MlsFit::Kind::translation;
    if (one_line_ && !turned && kind == MlsFit::Kind::affine) kind = MlsFit::Kind::similarity;

    Eigen::VectorXcd x = rest_;
    double energy = 0;
    for (Eigen::Index v = 0; v < rest_.size(); ++v) {
        const auto i = static_cast<std::size_t>(v);
        if (binding_.loose[i]) continue;
        if (control_[i] >= 0) {
            x(v) = targets.maps[static_cast<std::size_t>(control_[i])](rest_(v));
            continue;
        }
        const MlsFit fit = fit_at(rest_(v), moments_.data() + i * curves_.size(), moved, targets);
        const MlsFit::Displacement fitted = fit.solve(kind);
        x(v) += fitted.at_centre;
        energy += fitted.residual;
    }
    for (std::size_t k = 0; k < binding_.vertices.size(); ++k) {
        x(binding_.vertices[k].vertex) = targets.vertices(static_cast<Eigen::Index>(k));
    }
    Deformation result;
    result.V = point_positions(x);
    result.energy = energy / static_cast<double>(rest_.size());
    result.energy_history = {result.energy};
    result.max_handle_error_px = largest_error(moved, targets, kind);
    result.warnings = warnings(pose);
    return result;
}

}  // namespace puppetwarp
