#include <puppetwarp/mesh/extended_mesh.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/mesh/boundary_edges.h>
#include <puppetwarp/mesh/constrained_triangles.h>
#include <puppetwarp/mesh/locate.h>
#include <puppetwarp/mesh/outline.h>
#include <puppetwarp/mesh/segment_grid.h>

#include <CGAL/exceptions.h>
#include <CGAL/hilbert_sort.h>
#include <CGAL/property_map.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <limits>
#include <utility>

namespace puppetwarp {

namespace {

// A vertex nearer to a ring than this share of its shortest edge crowds it.
constexpr double crowding = 0.25;
constexpr double min_angle_deg = 20;
// Longest edge of what the rings add, in mean edges of the mesh; and where rings are far larger, by their size.
constexpr double longest_edge = 4;
constexpr double longest_edge_share = 1.0 / 60;

double distance(const Segment& s, const Point& p) {
    const Point way = s.b - s.a;
    const double along = std::clamp(way.dot(p - s.a) / way.squaredNorm(), 0.0, 1.0);
    return (s.a + along * way - p).norm();
}

class Extension {
public:
    Extension(const TriangleMesh& mesh, const std::vector<Polyline>& rings, const std::vector<int>& keep)
        : mesh_(mesh), rings_(rings), at_(static_cast<std::size_t>(mesh.V.rows())) {
        for (const Polyline& ring : rings) {
            Outline& within = within_.emplace_back();
            within.components.push_back({ring, {}});
            for (std::size_t k = 0; k < ring.size(); ++k) {
                edges_.push_back({ring[k], ring[(k + 1) % ring.size()]});
                boxes_.emplace_back(edges_.back().a.cwiseMin(edges_.back().b),
                                    edges_.back().a.cwiseMax(edges_.back().b));
            }
        }
        measure_edges();
        choose_kept(keep);
    }

    ExtendedMesh build() {
        insert_frame();
        insert_rings();
        insert_vertices();
        insert_boundary();
        mark_domain();
        refine_domain();
        ExtendedMesh result{domain_triangles(cdt_), {}};
        for (const Cdt::Vertex_handle vertex : at_) {
            result.place.push_back(vertex == Cdt::Vertex_handle() ? -1 : vertex->info());
        }
        return result;
    }

private:
    Point position(int v) const { return mesh_.V.row(v).transpose(); }
    bool in_ring(const Point& p) const {
        return std::any_of(within_.begin(), within_.end(), [&](const Outline& ring) { return contains(ring, p); });
    }

    void measure_edges() {
        shortest_.assign(at_.size(), std::numeric_limits<double>::infinity());
        for (Eigen::Index t = 0; t < mesh_.F.rows(); ++t) {
            for (int k = 0; k < 3; ++k) {
                const int a = mesh_.F(t, k), b = mesh_.F(t, (k + 1) % 3);
                const double length = (position(b) - position(a)).norm();
                mean_edge_ += length / static_cast<double>(3 * mesh_.F.rows());
                for (const int v : {a, b}) {
                    double& shortest = shortest_[static_cast<std::size_t>(v)];
                    shortest = std::min(shortest, length);
                }
            }
        }
    }

    bool crowds_ring(int v) const {
        const double least = crowding * shortest_[static_cast<std::size_t>(v)];
        const Point p = position(v);
        for (std::size_t e = 0; e < edges_.size(); ++e) {
            if (boxes_[e].squaredExteriorDistance(p) < least * least && distance(edges_[e], p) < least) return true;
        }
        return false;
    }

    void choose_kept(const std::vector<int>& keep) {
        kept_.resize(at_.size());
        for (std::size_t v = 0; v < kept_.size(); ++v) kept_[v] = !crowds_ring(static_cast<int>(v));
        for (const int v : keep) kept_[static_cast<std::size_t>(v)] = true;
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

    void insert_vertices() {
        std::vector<std::pair<Cdt::Point, int>> order;
        for (std::size_t v = 0; v < at_.size(); ++v) {
            const auto vertex = static_cast<int>(v);
            if (kept_[v]) order.emplace_back(Cdt::Point(mesh_.V(vertex, 0), mesh_.V(vertex, 1)), vertex);
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
        for (const auto& [a, b] : boundary_edges(mesh_)) {
            const Segment s{position(a), position(b)};
            if (!kept_[static_cast<std::size_t>(a)] || !kept_[static_cast<std::size_t>(b)]) continue;
            if (in_ring(0.5 * (s.a + s.b)) || meets_ring(s)) continue;
            cdt_.insert_constraint(at_[static_cast<std::size_t>(a)], at_[static_cast<std::size_t>(b)]);
        }
    }

    // Triangles whose centroids the mesh or a ring holds. Between what is held and what is not, edges become
    // constraints, so that refinement keeps to the domain.
    void mark_domain() {
        const MeshLocator locator(mesh_);
        for (const Cdt::Face_handle face : cdt_.finite_face_handles()) {
            Point centroid = Point::Zero();
            for (int k = 0; k < 3; ++k)
                centroid += Point(face->vertex(k)->point().x(), face->vertex(k)->point().y()) / 3;
            face->set_in_domain(in_ring(centroid) || locator.locate(centroid).distance_px == 0);
        }
        std::vector<std::pair<Cdt::Vertex_handle, Cdt::Vertex_handle>> border;
        const auto in_domain = [&](Cdt::Face_handle face) { return !cdt_.is_infinite(face) && face->is_in_domain(); };
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

    const TriangleMesh& mesh_;
    const std::vector<Polyline>& rings_;
    std::vector<Outline> within_;
    std::vector<Segment> edges_;  // of the rings
    std::vector<Eigen::AlignedBox2d> boxes_;
    std::vector<double> shortest_;  // edge of each vertex
    double mean_edge_ = 0;
    std::vector<bool> kept_;
    std::vector<Cdt::Vertex_handle> at_;  // of each vertex of the mesh
    Cdt cdt_;
};

}  // namespace

ExtendedMesh extended_mesh(const TriangleMesh& mesh, const std::vector<Polyline>& rings, const std::vector<int>& keep) {
    try {
        return Extension(mesh, rings, keep).build();
    } catch (const CGAL::Failure_exception&) {
        // CGAL's checks found a triangle that round-off made flat.
        throw InvalidInput("cage", "it is too narrow for its length, somewhere, to compute with", "widen it");
    }
}

}  // namespace puppetwarp
