#include <puppetwarp/mesh/extended_mesh.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/mesh/constrained_triangles.h>
#include <puppetwarp/mesh/locate.h>
#include <puppetwarp/mesh/mesh_core.h>
#include <puppetwarp/mesh/outline.h>
#include <puppetwarp/mesh/segment_grid.h>

#include <CGAL/exceptions.h>
#include <CGAL/hilbert_sort.h>
#include <CGAL/property_map.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cassert>
#include <limits>
#include <optional>
#include <set>
#include <utility>

namespace puppetwarp {

namespace {

// A vertex nearer to a ring than this share of its shortest edge crowds it.
constexpr double crowding = 0.25;
constexpr double min_angle_deg = 20;
// What is made anew reaches so many triangles into the mesh from its boundary and from the rings.
constexpr int loose_layers = 1;
// Longest edge of what the rings add, in mean edges of the mesh; and where rings are far larger, by their size.
constexpr double longest_edge = 4;
constexpr double longest_edge_share = 1.0 / 60;

double distance(const Segment& s, const Point& p) {
    const Point way = s.b - s.a;
    const double along = std::clamp(way.dot(p - s.a) / way.squaredNorm(), 0.0, 1.0);
    return (s.a + along * way - p).norm();
}

// The core of the mesh stays; around it, everything is triangulated anew.
class Extension {
public:
    Extension(const TriangleMesh& mesh, const std::vector<Polyline>& rings, const std::vector<int>& keep)
        : mesh_(mesh), core_(mesh), kept_(static_cast<std::size_t>(mesh.V.rows()), true), at_(kept_.size()) {
        for (const Polyline& ring : rings) {
            Outline& within = within_.emplace_back();
            within.components.push_back({ring, {}});
            for (std::size_t k = 0; k < ring.size(); ++k) {
                edges_.push_back({ring[k], ring[(k + 1) % ring.size()]});
                boxes_.emplace_back(edges_.back().a.cwiseMin(edges_.back().b),
                                    edges_.back().a.cwiseMax(edges_.back().b));
            }
        }
        choose_kept(keep);
    }

    // \param with_core  false: nothing of the mesh stays.
    // \return none when what was made anew came too near to the core.
    std::optional<ExtendedMesh> build(bool with_core) {
        if (!with_core) core_.loosen(std::vector<bool>(at_.size(), true), 0);
        insert_frame();
        insert_rings();
        insert_vertices();
        insert_boundary();
        settle_core();
        if (!mark_core()) return std::nullopt;
        mark_domain();
        refine_domain();
        if (!fallen_edges().empty()) return std::nullopt;
        return assembled();
    }

private:
    Point position(int v) const { return mesh_.V.row(v).transpose(); }
    Cdt::Vertex_handle at(int v) const { return at_[static_cast<std::size_t>(v)]; }
    bool in_ring(const Point& p) const {
        return std::any_of(within_.begin(), within_.end(), [&](const Outline& ring) { return contains(ring, p); });
    }

    // Of the edges at each vertex. Sets their mean, too.
    void measure_edges(std::vector<double>& shortest, std::vector<double>& longest) {
        const Eigen::MatrixX3i& F = core_.triangles();
        for (Eigen::Index t = 0; t < F.rows(); ++t) {
            for (int k = 0; k < 3; ++k) {
                const auto a = static_cast<std::size_t>(F(t, k)), b = static_cast<std::size_t>(F(t, (k + 1) % 3));
                const double length = (mesh_.V.row(F(t, (k + 1) % 3)) - mesh_.V.row(F(t, k))).norm();
                mean_edge_ += length / static_cast<double>(3 * F.rows());
                for (const std::size_t v : {a, b}) {
                    shortest[v] = std::min(shortest[v], length);
                    longest[v] = std::max(longest[v], length);
                }
            }
        }
    }

    // Distance of a vertex from the rings where that is less than `most`, else `most`.
    double ring_distance(int v, double most) const {
        const Point p = position(v);
        for (std::size_t e = 0; e < edges_.size(); ++e) {
            if (boxes_[e].squaredExteriorDistance(p) < most * most) most = std::min(most, distance(edges_[e], p));
        }
        return most;
    }

    // Vertices that crowd a ring go; the core keeps off rings and boundary.
    void choose_kept(const std::vector<int>& keep) {
        std::vector<double> shortest(at_.size(), std::numeric_limits<double>::infinity()), longest(at_.size(), 0);
        measure_edges(shortest, longest);
        std::vector<bool> loose(at_.size());
        for (int v = 0; v < mesh_.V.rows(); ++v) {
            const auto i = static_cast<std::size_t>(v);
            // A ring that is farther away than this crosses no triangle at the vertex.
            const double away = ring_distance(v, longest[i]);
            loose[i] = away < longest[i];
            kept_[i] = !loose[i] || away >= crowding * shortest[i];
            within_rings_ = within_rings_ && !loose[i];
        }
        for (const int v : keep) kept_[static_cast<std::size_t>(v)] = true;
        for (const auto& [a, b] : core_.boundary()) {
            loose[static_cast<std::size_t>(a)] = true;
            within_rings_ = within_rings_ && in_ring(position(a));
        }
        core_.loosen(std::move(loose), loose_layers);
    }

    // Far around everything, so that where a ring hardly bends, its corners make no slivers on the side away from the
    // domain: places on its edges are rounded, and could be beyond those.
    void insert_frame() {
        Eigen::AlignedBox2d box;
        for (const Segment& edge : edges_) box.extend(edge.a);
        for (Eigen::Index v = 0; v < mesh_.V.rows(); ++v) box.extend(Point(mesh_.V.row(v).transpose()));
        const double reach = box.diagonal().norm();
        for (const double x : {box.min().x() - reach, box.max().x() + reach}) {
            for (const double y : {box.min().y() - reach, box.max().y() + reach}) cdt_.insert({x, y});
        }
    }

    void insert_rings() {
        for (const Segment& edge : edges_) {
            const Cdt::Vertex_handle a = cdt_.insert({edge.a.x(), edge.a.y()}),
                                     b = cdt_.insert({edge.b.x(), edge.b.y()});
            cdt_.insert_constraint(a, b);
        }
    }

    // Those that are kept and not inside the core; again after it has shrunk.
    void insert_vertices() {
        const std::vector<bool> inner = core_.inner_vertices();
        std::vector<std::pair<Cdt::Point, int>> order;
        for (std::size_t v = 0; v < at_.size(); ++v) {
            const auto vertex = static_cast<int>(v);
            if (!kept_[v] || inner[v] || at_[v] != Cdt::Vertex_handle()) continue;
            order.emplace_back(Cdt::Point(mesh_.V(vertex, 0), mesh_.V(vertex, 1)), vertex);
        }
        using Of = CGAL::First_of_pair_property_map<std::pair<Cdt::Point, int>>;
        CGAL::hilbert_sort(order.begin(), order.end(), CGAL::Spatial_sort_traits_adapter_2<Kernel, Of>(Of{}));
        Cdt::Face_handle near;
        for (const auto& [point, v] : order) {
            const Cdt::Vertex_handle vertex = cdt_.insert(point, near);
            at_[static_cast<std::size_t>(v)] = vertex;
            near = vertex->face();
        }
    }

    // Whether an edge of the mesh comes so near to a ring that both together would make slivers.
    bool meets_ring(const Segment& s) const {
        const double least = crowding * (s.b - s.a).norm();
        return std::any_of(edges_.begin(), edges_.end(),
                           [&](const Segment& edge) { return segments_meet(s, edge) || distance(s, edge.a) < least; });
    }

    void insert_boundary() {
        for (const auto& [a, b] : core_.boundary()) {
            const Segment s{position(a), position(b)};
            if (!kept_[static_cast<std::size_t>(a)] || !kept_[static_cast<std::size_t>(b)]) continue;
            if (in_ring(0.5 * (s.a + s.b)) || meets_ring(s)) continue;
            cdt_.insert_constraint(at(a), at(b));
        }
    }

    // Edges of the core's border that are none of the triangulation.
    std::vector<std::pair<int, int>> fallen_edges() {
        std::vector<std::pair<int, int>> edges = core_.border();
        std::erase_if(edges, [&](const auto& edge) { return cdt_.is_edge(at(edge.first), at(edge.second)); });
        return edges;
    }

    // Where its border is not made of edges of the triangulation, the core gives way.
    void settle_core() {
        for (auto fallen = fallen_edges(); !fallen.empty(); fallen = fallen_edges()) {
            std::vector<bool> ends(at_.size());
            for (const auto& [a, b] : fallen)
                ends[static_cast<std::size_t>(a)] = ends[static_cast<std::size_t>(b)] = true;
            core_.loosen(std::move(ends), 0);
            insert_vertices();
        }
    }

    // Collects the triangles in place of the core. \return false when they are not enclosed by its border.
    bool mark_core() {
        std::set<std::pair<Cdt::Vertex_handle, Cdt::Vertex_handle>> border;
        std::vector<Cdt::Face_handle> open;
        for (const auto& [a, b] : core_.border()) {
            border.insert(std::minmax(at(a), at(b)));
            Cdt::Face_handle face;
            int side = 0;
            cdt_.is_edge(at(a), at(b), face, side);
            open.push_back(face->vertex(Cdt::ccw(side)) == at(a) ? face : face->neighbor(side));
        }
        while (!open.empty()) {
            const Cdt::Face_handle face = open.back();
            open.pop_back();
            if (cdt_.is_infinite(face)) return false;
            if (!in_core_.insert(face).second) continue;
            for (int k = 0; k < 3; ++k) {
                const Cdt::Vertex_handle a = face->vertex(Cdt::ccw(k)), b = face->vertex(Cdt::cw(k));
                if (!border.contains(std::minmax(a, b))) open.push_back(face->neighbor(k));
            }
        }
        return true;
    }

    // Triangles whose centroids the mesh or a ring holds, but for those in place of the core. Between what is held and
    // what is not, edges become constraints, so that refinement keeps to the domain.
    void mark_domain() {
        std::optional<MeshLocator> locator;
        if (!within_rings_) locator.emplace(mesh_);
        const auto held = [&](const Point& p) {
            return in_ring(p) || (locator && locator->locate(p).distance_px == 0);
        };
        const auto in_core = [&](const Cdt::Face_handle& face) { return in_core_.contains(face); };
        for (const Cdt::Face_handle face : cdt_.finite_face_handles()) {
            Point centroid = Point::Zero();
            for (int k = 0; k < 3; ++k)
                centroid += Point(face->vertex(k)->point().x(), face->vertex(k)->point().y()) / 3;
            face->set_in_domain(!in_core(face) && held(centroid));
        }
        std::vector<std::pair<Cdt::Vertex_handle, Cdt::Vertex_handle>> border;
        const auto in_domain = [&](const Cdt::Face_handle& face) {
            return !cdt_.is_infinite(face) && (face->is_in_domain() || in_core(face));
        };
        for (const Cdt::Edge& edge : cdt_.finite_edges()) {
            const auto [face, side] = edge;
            if (cdt_.is_constrained(edge) || in_domain(face) == in_domain(face->neighbor(side))) continue;
            border.emplace_back(face->vertex(Cdt::cw(side)), face->vertex(Cdt::ccw(side)));
        }
        for (const auto& [a, b] : border) cdt_.insert_constraint(a, b);
    }

    void refine_domain() {
        Eigen::AlignedBox2d box;
        for (const Segment& edge : edges_) box.extend(edge.a);
        const double longest = std::max(longest_edge * mean_edge_, longest_edge_share * box.diagonal().norm());
        Mesher mesher(cdt_, Criteria(squared_sine(min_angle_deg), longest));
        mesher.init(true);
        // A mesh of needles would be refined far beyond its own density: then, what there is must do.
        puppetwarp::refine_domain(mesher, cdt_, 20000 + 4 * at_.size());
    }

    // What was made anew, then the core.
    ExtendedMesh assembled() {
        ExtendedMesh result{domain_triangles(cdt_), std::vector<int>(at_.size(), -1)};
        std::vector<int> inner;
        const std::vector<bool> is_inner = core_.inner_vertices();
        const auto made = static_cast<int>(result.mesh.V.rows());
        for (std::size_t v = 0; v < at_.size(); ++v) {
            if (is_inner[v]) {
                result.place[v] = made + static_cast<int>(inner.size());
                inner.push_back(static_cast<int>(v));
            } else if (at_[v] != Cdt::Vertex_handle()) {
                result.place[v] = at_[v]->info();
            }
        }
        result.mesh.V.conservativeResize(made + static_cast<Eigen::Index>(inner.size()), 2);
        for (std::size_t i = 0; i < inner.size(); ++i)
            result.mesh.V.row(made + static_cast<Eigen::Index>(i)) = mesh_.V.row(inner[i]);
        const Eigen::MatrixX3i& F = core_.triangles();
        Eigen::Index row = result.mesh.F.rows();
        result.mesh.F.conservativeResize(row + F.rows(), 3);
        for (Eigen::Index t = 0; t < F.rows(); ++t) {
            if (!core_.holds(t)) continue;
            for (int k = 0; k < 3; ++k) result.mesh.F(row, k) = result.place[static_cast<std::size_t>(F(t, k))];
            ++row;
        }
        result.mesh.F.conservativeResize(row, 3);
        return result;
    }

    const TriangleMesh& mesh_;
    MeshCore core_;
    std::vector<Outline> within_;
    std::vector<Segment> edges_;  // of the rings
    std::vector<Eigen::AlignedBox2d> boxes_;
    double mean_edge_ = 0;
    bool within_rings_ = true;            // all of the mesh
    std::vector<bool> kept_;              // of the vertices of the mesh
    std::vector<Cdt::Vertex_handle> at_;  // of each vertex of the mesh
    Cdt cdt_;
    std::set<Cdt::Face_handle> in_core_;
};

}  // namespace

ExtendedMesh extended_mesh(const TriangleMesh& mesh, const std::vector<Polyline>& rings, const std::vector<int>& keep) {
    try {
        for (const bool with_core : {true, false}) {
            if (std::optional<ExtendedMesh> result = Extension(mesh, rings, keep).build(with_core))
                return *std::move(result);
        }
        assert(false);  // with nothing to come too near to, there is always one
        return {};
    } catch (const CGAL::Failure_exception&) {
        // CGAL's checks found a triangle that round-off made flat.
        throw InvalidInput("cage", "it is too narrow for its length, somewhere, to compute with", "widen it");
    }
}

}  // namespace puppetwarp
