#include <puppetwarp/weights/weight_conditions.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/mesh/locate.h>
#include <puppetwarp/mesh/segment_grid.h>
#include <puppetwarp/rig/binding.h>
#include <puppetwarp/rig/region.h>
#include <puppetwarp/weights/segment_foot.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <limits>
#include <optional>
#include <set>

namespace puppetwarp {

namespace {

// About joints bones hold nothing within this share of the subject's diagonal, and of their own length.
constexpr double joint_share = 0.02;
constexpr double joint_share_of_bone = 0.25;

std::string place_text(const Point& p) {
    std::array<char, 64> text{};
    std::snprintf(text.data(), text.size(), "(%.5g, %.5g)", p.x(), p.y());
    return text.data();
}

// Bones whose grip is loosened where they meet others.
class Joints {
public:
    Joints(const TriangleMesh& mesh, const Rig& rig, double size) : rig_(rig), size_(size), at_(rig.handles.size()) {
        for (std::size_t b = 0; b < rig.handles.size(); ++b) {
            const BoneHandle* bone = bone_at(b);
            if (bone == nullptr) continue;
            for (std::size_t h = 0; h < rig.handles.size(); ++h) {
                if (h == b) continue;
                if (const auto* point = std::get_if<PointHandle>(&rig.handles[h].shape)) meet(b, point->at);
                if (const auto* vertex = std::get_if<VertexHandle>(&rig.handles[h].shape)) {
                    meet(b, mesh.V.row(vertex->index).transpose());
                }
                if (h < b && bone_at(h) != nullptr) meet(b, *bone, h, *bone_at(h));
            }
        }
    }

    // Whether a place is so near to a joint of a bone that the bone leaves it alone.
    bool frees(std::size_t b, const Point& p) const {
        const BoneHandle& bone = *bone_at(b);
        const double radius = std::min(joint_share * size_, joint_share_of_bone * (bone.to - bone.from).norm());
        return std::any_of(at_[b].begin(), at_[b].end(),
                           [&](const Point& joint) { return (joint - p).norm() < radius; });
    }
    bool related(std::size_t a, std::size_t b) const { return pairs_.count({std::min(a, b), std::max(a, b)}) > 0; }

private:
    const BoneHandle* bone_at(std::size_t h) const { return std::get_if<BoneHandle>(&rig_.handles[h].shape); }

    // Where a point lies on a bone.
    void meet(std::size_t b, const Point& p) {
        const BoneHandle& bone = *bone_at(b);
        if (segment_foot(bone.from, bone.to, p).distance <= one_place * size_) at_[b].push_back(p);
    }

    // Where an end of one bone lies on another.
    void meet(std::size_t b, const BoneHandle& bone, std::size_t o, const BoneHandle& other) {
        const auto touches = [&](const BoneHandle& on, const Point& end) {
            return segment_foot(on.from, on.to, end).distance <= one_place * size_;
        };
        for (const Point& end : {bone.from, bone.to}) {
            if (touches(other, end)) join(b, o, end);
        }
        for (const Point& end : {other.from, other.to}) {
            if (touches(bone, end)) join(b, o, end);
        }
        if (related(b, o) || !segments_meet({bone.from, bone.to}, {other.from, other.to})) return;
        const Point u = bone.to - bone.from, v = other.to - other.from, between = other.from - bone.from;
        const double cross = u.x() * v.y() - u.y() * v.x();
        const Point crossing = bone.from + u * ((between.x() * v.y() - between.y() * v.x()) / cross);
        throw InvalidInput("handles '" + rig_.handles[o].id + "' and '" + rig_.handles[b].id + "'",
                           "the bones cross each other at " + place_text(crossing),
                           "let them meet at an end, or move them apart");
    }

    void join(std::size_t b, std::size_t o, const Point& p) {
        at_[b].push_back(p);
        at_[o].push_back(p);
        pairs_.insert({std::min(b, o), std::max(b, o)});
    }

    const Rig& rig_;
    double size_;
    std::vector<std::vector<Point>> at_;  // of each bone
    std::set<std::pair<std::size_t, std::size_t>> pairs_;
};

// What one vertex is held by.
struct Claim {
    std::size_t handle = 0;
    int corner = 0;       // of a cage: where the edge starts
    double along = 0;     // of a cage: the share of the way to its end
    bool shared = false;  // by bones of one joint, which then leave it alone
};

class Conditions {
public:
    Conditions(const TriangleMesh& mesh, const Rig& rig)
        : mesh_(mesh), rig_(rig), size_(bounding_diagonal(mesh.V)), claims_(static_cast<std::size_t>(mesh.V.rows())) {
        found_.columns = weight_columns(rig);
    }

    WeightConditions take() {
        for (handle_ = 0; handle_ < rig_.handles.size(); ++handle_) {
            std::visit([this](const auto& shape) { check(shape); }, rig_.handles[handle_].shape);
        }
        const Joints joints(mesh_, rig_, size_);
        joints_ = &joints;
        for (handle_ = 0; handle_ < rig_.handles.size(); ++handle_) {
            std::visit([this](const auto& shape) { hold(shape); }, rig_.handles[handle_].shape);
        }
        fill_values();
        return std::move(found_);
    }

private:
    Point position(int vertex) const { return mesh_.V.row(vertex).transpose(); }
    const std::string& id() const { return rig_.handles[handle_].id; }

    const MeshLocator& locator() const {
        if (!locator_) locator_.emplace(mesh_);
        return *locator_;
    }
    MeshLocation located(const Point& at) const {
        MeshLocation place = locator().locate(at);
        if (place.distance_px > on_border * size_) throw_outside(id(), place.distance_px);
        return place;
    }
    // Ties, of which regular meshes are full, go to the lowest index and not to round-off, so that a rig takes hold of
    // a mesh at every size and place in the same way.
    int nearest_corner(const MeshLocation& place) const {
        constexpr double tie = 1e-6;
        const double largest = place.barycentric.maxCoeff();
        int nearest = -1;
        for (int k = 0; k < 3; ++k) {
            const int vertex = mesh_.F(place.triangle, k);
            if (place.barycentric(k) >= largest - tie && (nearest < 0 || vertex < nearest)) nearest = vertex;
        }
        return nearest;
    }

    void check(const PointHandle& point) const { located(point.at); }
    void check(const BoneHandle& bone) const {
        located(bone.from);
        located(bone.to);
    }
    void check(const VertexHandle& vertex) const { require_vertex(mesh_, id(), vertex); }
    void check(const RegionHandle&) const {}
    void check(const CageHandle&) const {}

    void hold(const PointHandle& point) { claim(nearest_corner(located(point.at))); }
    void hold(const VertexHandle& vertex) { claim(vertex.index); }
    void hold(const RegionHandle& region) {
        bool holds = false;
        for (int v = 0; v < mesh_.V.rows(); ++v) {
            if (!inside(region.points, position(v))) continue;
            claim(v);
            holds = true;
        }
        if (holds) return;
        throw InvalidInput("handle '" + id() + "'", "no vertex of the mesh lies inside the region",
                           "draw it larger and on the subject, or make the mesh finer");
    }
    void hold(const BoneHandle& bone);
    void hold(const CageHandle& cage);

    void claim(int vertex, int corner = 0, double along = 0);
    // Of what a cage holds: where the edge ends.
    int next_corner(const Claim& claim) const {
        const auto& cage = std::get<CageHandle>(rig_.handles[claim.handle].shape);
        return (claim.corner + 1) % static_cast<int>(cage.points.size());
    }
    void fill_values();
    void hold_lone_components();
    std::size_t nearest_column(const std::vector<int>& vertices) const;
    double distance_to(const WeightColumn& column, const Point& p) const;
    void require_all_hold(const std::vector<Eigen::Index>& first) const;

    const TriangleMesh& mesh_;
    const Rig& rig_;
    double size_;
    mutable std::optional<MeshLocator> locator_;  // cages need none
    const Joints* joints_ = nullptr;
    std::size_t handle_ = 0;  // that takes hold now
    std::vector<std::optional<Claim>> claims_;
    WeightConditions found_;
};

void Conditions::hold(const BoneHandle& bone) {
    const Point along = bone.to - bone.from;
    const double length = along.norm();
    // Steps that miss no triangle of more than a sliver.
    constexpr double step_share = 0.2;
    const double least_step = 1e-5 * length;
    const auto shortest_edge = [&](int triangle) {
        double shortest = std::numeric_limits<double>::infinity();
        for (int k = 0; k < 3; ++k) {
            const Point edge = position(mesh_.F(triangle, (k + 1) % 3)) - position(mesh_.F(triangle, k));
            shortest = std::min(shortest, edge.norm());
        }
        return shortest;
    };
    std::optional<int> middle;  // of what it could hold, the vertex farthest from both ends
    double middle_reach = -1;
    bool holds = false;
    for (double walked = 0;;) {
        const Point at = walked < length ? Point(bone.from + along * (walked / length)) : bone.to;
        const MeshLocation place = locator().locate(at);
        if (place.distance_px <= on_border * size_) {
            const int vertex = nearest_corner(place);
            const double reach = std::min(walked, length - walked);
            if (reach > middle_reach) {
                middle = vertex;
                middle_reach = reach;
            }
            if (!joints_->frees(handle_, position(vertex))) {
                claim(vertex);
                holds = true;
            }
        }
        if (!(walked < length)) break;
        walked += std::max(least_step, step_share * shortest_edge(place.triangle));
    }
    if (!holds && middle) claim(*middle);  // the mesh is coarser than the joints are large
}

void Conditions::hold(const CageHandle& cage) {
    const std::size_t corners = cage.points.size();
    for (std::size_t k = 0; k < corners; ++k) {
        const Point &a = cage.points[k], &b = cage.points[(k + 1) % corners];
        const double near = on_cage_edge * size_;
        const Point low = a.cwiseMin(b).array() - near, high = a.cwiseMax(b).array() + near;
        for (int v = 0; v < mesh_.V.rows(); ++v) {
            const Point p = position(v);
            if ((p.array() < low.array()).any() || (p.array() > high.array()).any()) continue;
            const SegmentFoot foot = segment_foot(a, b, p);
            if (foot.distance <= near) claim(v, static_cast<int>(k), foot.along);
        }
    }
}

void Conditions::claim(int vertex, int corner, double along) {
    std::optional<Claim>& held = claims_[static_cast<std::size_t>(vertex)];
    if (!held) {
        held = Claim{handle_, corner, along, false};
        return;
    }
    if (held->handle == handle_) return;
    if (joints_->related(held->handle, handle_)) {
        held->shared = true;
        return;
    }
    throw InvalidInput("handles '" + rig_.handles[held->handle].id + "' and '" + id() + "'",
                       "they hold one vertex of the mesh, at " + place_text(position(vertex)),
                       "move them apart, or make the mesh finer");
}

void Conditions::fill_values() {
    for (auto& held : claims_) {
        if (held && held->shared) held.reset();
    }
    std::vector<Eigen::Index> first(rig_.handles.size(), -1);
    for (std::size_t c = found_.columns.size(); c-- > 0;) {
        first[static_cast<std::size_t>(found_.columns[c].handle)] = static_cast<Eigen::Index>(c);
    }
    require_all_hold(first);
    hold_lone_components();
    const auto count = std::count_if(claims_.begin(), claims_.end(), [](const auto& held) { return held.has_value(); });
    found_.values = Eigen::MatrixXd::Zero(count, static_cast<Eigen::Index>(found_.columns.size()));
    for (std::size_t v = 0; v < claims_.size(); ++v) {
        if (!claims_[v]) continue;
        const Claim& held = *claims_[v];
        const auto row = static_cast<Eigen::Index>(found_.vertices.size());
        const Eigen::Index column = first[held.handle] + held.corner;
        found_.values(row, column) = 1 - held.along;
        if (held.along > 0) found_.values(row, first[held.handle] + next_corner(held)) += held.along;
        found_.vertices.push_back(static_cast<int>(v));
    }
}

void Conditions::hold_lone_components() {
    const Eigen::VectorXi component = vertex_components(mesh_);
    std::vector<std::vector<int>> members(static_cast<std::size_t>(component.maxCoeff()) + 1);
    std::vector<bool> held(members.size());
    for (int v = 0; v < component.size(); ++v) {
        const auto c = static_cast<std::size_t>(component(v));
        members[c].push_back(v);
        if (claims_[static_cast<std::size_t>(v)]) held[c] = true;
    }
    for (std::size_t c = 0; c < members.size(); ++c) {
        if (held[c]) continue;
        const WeightColumn column = found_.columns[nearest_column(members[c])];
        Point middle = Point::Zero();
        for (const int v : members[c]) {
            claims_[static_cast<std::size_t>(v)] =
                Claim{static_cast<std::size_t>(column.handle), std::max(column.corner, 0), 0, false};
            middle += position(v);
        }
        if (members[c].size() < 3) continue;  // of no triangle: shows nothing
        found_.warnings.push_back("the part of the subject around " +
                                  place_text(middle / static_cast<double>(members[c].size())) +
                                  " has no handle and follows the nearest, '" + column_name(rig_, column) + "'");
    }
}

std::size_t Conditions::nearest_column(const std::vector<int>& vertices) const {
    std::size_t nearest = 0;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t c = 0; c < found_.columns.size(); ++c) {
        for (const int v : vertices) {
            const double distance = distance_to(found_.columns[c], position(v));
            if (distance >= least) continue;
            least = distance;
            nearest = c;
        }
    }
    return nearest;
}

double Conditions::distance_to(const WeightColumn& column, const Point& p) const {
    const auto& shape = rig_.handles[static_cast<std::size_t>(column.handle)].shape;
    if (const auto* point = std::get_if<PointHandle>(&shape)) return (point->at - p).norm();
    if (const auto* vertex = std::get_if<VertexHandle>(&shape)) return (position(vertex->index) - p).norm();
    if (const auto* bone = std::get_if<BoneHandle>(&shape)) return segment_foot(bone->from, bone->to, p).distance;
    if (const auto* cage = std::get_if<CageHandle>(&shape)) {
        return (cage->points[static_cast<std::size_t>(column.corner)] - p).norm();
    }
    const Polyline& region = std::get<RegionHandle>(shape).points;
    double distance = inside(region, p) ? 0 : std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < region.size(); ++k) {
        distance = std::min(distance, segment_foot(region[k], region[(k + 1) % region.size()], p).distance);
    }
    return distance;
}

void Conditions::require_all_hold(const std::vector<Eigen::Index>& first) const {
    std::vector<bool> holds(found_.columns.size());
    for (const auto& held : claims_) {
        if (!held) continue;
        const auto mark = [&](int corner) { holds[static_cast<std::size_t>(first[held->handle] + corner)] = true; };
        if (held->along < 1) mark(held->corner);
        if (held->along > 0) mark(next_corner(*held));
    }
    for (std::size_t c = 0; c < holds.size(); ++c) {
        if (holds[c]) continue;
        throw InvalidInput("handle '" + column_name(rig_, found_.columns[c]) + "'",
                           "it holds no vertex of the mesh that it does not share",
                           "move it away from the others, or make the mesh finer");
    }
}

}  // namespace

void require_vertex(const TriangleMesh& mesh, const std::string& id, const VertexHandle& vertex) {
    if (vertex.index < mesh.V.rows()) return;
    throw InvalidInput("handle '" + id + "'", "index " + std::to_string(vertex.index) +
                                                  " is not a vertex: the mesh has " + std::to_string(mesh.V.rows()));
}

WeightConditions weight_conditions(const TriangleMesh& mesh, const Rig& rig) {
    return Conditions(mesh, rig).take();
}

}  // namespace puppetwarp
