#include <puppetwarp/rig/binding.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/rig/disc_holder.h>
#include <puppetwarp/rig/region.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <unordered_map>

namespace puppetwarp {

namespace {

using Complex = std::complex<double>;

Complex complex_of(const Point& p) {
    return {p.x(), p.y()};
}

// Finds the holds near a place without comparing all.
class PlaceGrid {
public:
    explicit PlaceGrid(double cell) : cell_(cell) {}

    void add(const Complex& place, int hold) { cells_[key(index(place.real()), index(place.imag()))].push_back(hold); }

    // Calls for each hold in the cell of a place and those around it.
    template <typename Visit>
    void around(const Complex& place, Visit visit) const {
        const std::int64_t x = index(place.real()), y = index(place.imag());
        for (std::int64_t j = y - 1; j <= y + 1; ++j) {
            for (std::int64_t i = x - 1; i <= x + 1; ++i) {
                const auto found = cells_.find(key(i, j));
                if (found == cells_.end()) continue;
                for (const int hold : found->second) visit(hold);
            }
        }
    }

private:
    std::int64_t index(double coordinate) const { return static_cast<std::int64_t>(std::floor(coordinate / cell_)); }
    static std::uint64_t key(std::int64_t x, std::int64_t y) {
        return (static_cast<std::uint64_t>(x) << 32) ^ (static_cast<std::uint64_t>(y) & 0xffffffffU);
    }

    double cell_;
    std::unordered_map<std::uint64_t, std::vector<int>> cells_;
};

// Takes hold with one handle after the other.
class Binder {
public:
    Binder(const DiscHolder& discs, const TriangleMesh& mesh, const Rig& rig, std::string_view user)
        : mesh_(mesh),
          rig_(rig),
          user_(user),
          discs_(discs),
          radius_(default_disc_share * discs_.size()),
          places_(one_place * discs_.size()) {}

    Binding binding() {
        for (handle_ = 0; handle_ < static_cast<int>(rig_.handles.size()); ++handle_) {
            std::visit([this](const auto& shape) { take(shape); }, handle().shape);
        }
        settle_vertices();
        find_loose();
        return std::move(binding_);
    }

private:
    const Handle& handle() const { return rig_.handles[static_cast<std::size_t>(handle_)]; }

    void take(const PointHandle& point);
    void take(const BoneHandle& bone);
    void take(const RegionHandle& region);
    void take(const VertexHandle& vertex);
    void take(const CageHandle&);
    MeshLocation located(const Point& at) const;
    void add(Hold hold);
    bool merge(const Hold& hold, int other);
    void settle_vertices();
    void find_loose();

    const TriangleMesh& mesh_;
    const Rig& rig_;
    std::string_view user_;
    const DiscHolder& discs_;
    double radius_;  // of discs that say none
    PlaceGrid places_;
    int handle_ = 0;  // that takes hold now
    Binding binding_;
};

MeshLocation Binder::located(const Point& at) const {
    MeshLocation place = discs_.locate(at);
    if (discs_.outside(place)) throw_outside(handle().id, place.distance_px);
    return place;
}

void Binder::take(const PointHandle& point) {
    add(discs_.hold(located(point.at), point.at, point.radius_px.value_or(radius_)));
}

void Binder::take(const BoneHandle& bone) {
    const MeshLocation start = located(bone.from), end = located(bone.to);
    const int gaps = std::max(1, static_cast<int>(std::ceil((bone.to - bone.from).norm() / radius_)));
    int last = -1;
    for (int i = 0; i <= gaps; ++i) {
        const Point at =
            i == gaps ? bone.to : Point(bone.from + (bone.to - bone.from) * (static_cast<double>(i) / gaps));
        const MeshLocation place = i == 0 ? start : i == gaps ? end : discs_.locate(at);
        if (discs_.outside(place)) continue;
        Hold hold = discs_.hold(place, at, radius_);
        // On a mesh so coarse that a triangle stands for the disc, one hold a triangle between the ends says all.
        const bool again = hold.mean.size() <= 3 && (place.triangle == last || place.triangle == end.triangle);
        if (again && i > 0 && i < gaps) continue;
        last = place.triangle;
        hold.turn.clear();
        hold.shear.clear();
        add(std::move(hold));
    }
}

void Binder::take(const RegionHandle& region) {
    const std::size_t before = binding_.vertices.size();
    for (int v = 0; v < mesh_.V.rows(); ++v) {
        if (inside(region.points, mesh_.V.row(v).transpose())) binding_.vertices.push_back({handle_, v});
    }
    if (binding_.vertices.size() > before) return;
    throw InvalidInput("handle '" + handle().id + "'", "no vertex of the mesh lies inside the region",
                       "draw it larger, or make the mesh finer");
}

void Binder::take(const VertexHandle& vertex) {
    if (vertex.index < 0 || vertex.index >= mesh_.V.rows()) {
        throw InvalidInput("handle '" + handle().id + "'", "index " + std::to_string(vertex.index) +
                                                               " is not a vertex: the mesh has " +
                                                               std::to_string(mesh_.V.rows()));
    }
    binding_.vertices.push_back({handle_, vertex.index});
}

void Binder::take(const CageHandle&) {
    throw InvalidInput("handle '" + handle().id + "'", "a cage cannot drive '" + std::string(user_) + "'",
                       "use the method lbs, or points, bones or regions");
}

// Whether the hold is the same as an earlier one, which then holds for both.
bool Binder::merge(const Hold& hold, int other) {
    Hold& earlier = binding_.holds[static_cast<std::size_t>(other)];
    if (hold.mean != earlier.mean) return false;
    if (earlier.turn.empty() && !hold.turn.empty()) earlier = hold;  // a point has more to say than a bone
    return true;
}

void Binder::add(Hold hold) {
    hold.handle = handle_;
    const double near = one_place * discs_.size();
    bool merged = false;
    places_.around(hold.at, [&](int other) {
        const Hold& earlier = binding_.holds[static_cast<std::size_t>(other)];
        if (merged || std::abs(earlier.at - hold.at) > near) return;
        Meeting meeting{earlier.handle, handle_, earlier.at, hold.at, near};
        const bool turns = !earlier.turn.empty() && !hold.turn.empty();
        merged = merge(hold, other);
        if (merged && turns) meeting.hold = other;
        if (meeting.first != meeting.second) binding_.meetings.push_back(meeting);
    });
    if (merged) return;
    places_.add(hold.at, static_cast<int>(binding_.holds.size()));
    binding_.holds.push_back(std::move(hold));
}

// Leaves each vertex to the first handle that holds it, and finds who else is there.
void Binder::settle_vertices() {
    std::vector<HeldVertex>& vertices = binding_.vertices;
    std::stable_sort(vertices.begin(), vertices.end(),
                     [](const HeldVertex& a, const HeldVertex& b) { return a.vertex < b.vertex; });
    const double near = one_vertex * discs_.size();
    std::size_t kept = 0;
    for (const HeldVertex held : vertices) {
        const Complex place = complex_of(mesh_.V.row(held.vertex).transpose());
        if (kept > 0 && vertices[kept - 1].vertex == held.vertex) {
            binding_.meetings.push_back({vertices[kept - 1].handle, held.handle, place, place, near, true});
            continue;
        }
        vertices[kept++] = held;
        places_.around(place, [&](int other) {
            const Hold& hold = binding_.holds[static_cast<std::size_t>(other)];
            if (std::abs(hold.at - place) > near || hold.handle == held.handle) return;
            binding_.meetings.push_back({hold.handle, held.handle, hold.at, place, near});
        });
    }
    vertices.resize(kept);
}

void Binder::find_loose() {
    const Eigen::VectorXi& component = discs_.component();
    const auto count = static_cast<std::size_t>(component.maxCoeff()) + 1;
    std::vector<bool> held(count);
    for (const Hold& hold : binding_.holds) held[static_cast<std::size_t>(hold.component)] = true;
    for (const HeldVertex& each : binding_.vertices) held[static_cast<std::size_t>(component(each.vertex))] = true;
    std::vector<int> size(count);
    std::vector<Point> sum(count, Point::Zero());
    binding_.loose.resize(static_cast<std::size_t>(component.size()));
    for (int v = 0; v < component.size(); ++v) {
        const auto c = static_cast<std::size_t>(component(v));
        binding_.loose[static_cast<std::size_t>(v)] = !held[c];
        ++size[c];
        sum[c] += mesh_.V.row(v).transpose();
    }
    // A vertex of no triangle shows nothing: nobody needs to hear of it.
    std::size_t parts = 0, largest = 0;
    for (std::size_t c = 0; c < count; ++c) {
        if (held[c] || size[c] < 3) continue;
        if (parts++ == 0 || size[c] > size[largest]) largest = c;
    }
    if (parts == 0) return;
    const Point middle = sum[largest] / size[largest];
    char place[64];
    std::snprintf(place, sizeof place, "(%.5g, %.5g)", middle.x(), middle.y());
    binding_.warnings.push_back(parts == 1 ? std::string("the part of the subject around ") + place +
                                                 " has no handle and stays where it is"
                                           : std::to_string(parts) +
                                                 " parts of the subject have no handle and stay "
                                                 "where they are, the largest around " +
                                                 place);
}

}  // namespace

Binding take_hold(const TriangleMesh& mesh, const Rig& rig, std::string_view user) {
    return take_hold(DiscHolder(mesh), mesh, rig, user);
}

Binding take_hold(const DiscHolder& discs, const TriangleMesh& mesh, const Rig& rig, std::string_view user) {
    if (rig.handles.empty()) throw InvalidInput("rig", "it has no handles", "set at least one");
    return Binder(discs, mesh, rig, user).binding();
}

void throw_outside(const std::string& id, double distance_px) {
    // Three digits, but never the nought that would say it is inside.
    char distance[64];
    std::snprintf(distance, sizeof distance, "%.3g", distance_px);
    throw InvalidInput("handle '" + id + "'", std::string("lies ") + distance + " px outside the subject",
                       "--pin-snap PX moves it onto the subject");
}

Complex row_value(const ComplexRow& row, const Eigen::VectorXcd& x) {
    Complex sum = 0;
    for (const auto& [vertex, coefficient] : row) sum += coefficient * x(vertex);
    return sum;
}

Eigen::VectorXcd complex_positions(const Eigen::MatrixX2d& V) {
    Eigen::VectorXcd x(V.rows());
    for (Eigen::Index v = 0; v < V.rows(); ++v) x(v) = Complex(V(v, 0), V(v, 1));
    return x;
}

Eigen::MatrixX2d point_positions(const Eigen::VectorXcd& x) {
    Eigen::MatrixX2d V(x.size(), 2);
    V.col(0) = x.real();
    V.col(1) = x.imag();
    return V;
}

}  // namespace puppetwarp
