#include <puppetwarp/mesh/triangulate.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/mesh/constrained_triangles.h>
#include <puppetwarp/mesh/triangulate_input.h>

#include <CGAL/exceptions.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace puppetwarp {

namespace {

void require_sound(const TriangulationOptions& options) {
    if (!(options.min_angle_deg >= 0 && options.min_angle_deg <= 30)) {
        throw InvalidInput("min_angle_deg", "must be from 0 to 30 degrees", "25 suits most pictures");
    }
    if (!std::isfinite(options.max_edge_px) || options.max_edge_px < 0) {
        throw InvalidInput("max_edge_px", "must be a length above 0, or 0 for the default");
    }
    if (options.max_vertices < 3) throw InvalidInput("max_vertices", "must be at least 3");
    if (options.optimize_iterations < 0) throw InvalidInput("optimize_iterations", "must be at least 0");
}

[[noreturn]] void refuse_size(int max_vertices) {
    throw InvalidInput("mesh", "more than " + std::to_string(max_vertices) + " vertices would be needed",
                       "raise max_edge_px, or lower min_angle_deg");
}

[[noreturn]] void refuse_narrow() {
    throw InvalidInput("outline",
                       "parts of it, or bones and cage edges in it, are too narrow for their length to compute with",
                       "widen them, or move lines apart that almost touch");
}

// Fewer vertices than this cannot do: no triangle is larger than the equilateral one, and n vertices make fewer than
// 2 n triangles.
void require_possible(const Outline& outline, double max_edge, int max_vertices) {
    double area = 0, length = 0;
    const auto add_length = [&](const Polyline& polygon) {
        for (std::size_t k = 0; k < polygon.size(); ++k) {
            length += (polygon[(k + 1) % polygon.size()] - polygon[k]).norm();
        }
    };
    for (const OutlineComponent& component : outline.components) {
        area += std::abs(signed_area(component.outer));
        add_length(component.outer);
        for (const Polyline& hole : component.holes) {
            area -= std::abs(signed_area(hole));
            add_length(hole);
        }
    }
    const double by_area = area / (std::numbers::sqrt3 / 4 * max_edge * max_edge) / 2;
    if (std::max(by_area, length / max_edge) > max_vertices) refuse_size(max_vertices);
}

class MeshBuilder {
public:
    MeshBuilder(double max_edge, const TriangulationOptions& options)
        : max_edge_(max_edge), options_(options), criteria_(squared_sine(options.min_angle_deg), max_edge) {}

    void insert_polygon(const Polyline& polygon) {
        std::vector<Cdt::Vertex_handle> vertices;
        Cdt::Face_handle near;
        for (const Point& point : polygon) {
            vertices.push_back(cdt_.insert({point.x(), point.y()}, near));
            near = vertices.back()->face();
        }
        for (std::size_t k = 0; k < vertices.size(); ++k) {
            cdt_.insert_constraint(vertices[k], vertices[(k + 1) % vertices.size()]);
        }
    }

    void insert_segment(const Segment& s) {
        const Cdt::Vertex_handle a = cdt_.insert({s.a.x(), s.a.y()});
        const Cdt::Vertex_handle b = cdt_.insert({s.b.x(), s.b.y()});
        if (a != b) cdt_.insert_constraint(a, b);
    }

    void insert_point(const Point& point) { fixed_.insert(cdt_.insert({point.x(), point.y()})); }

    // \param outside  a point in each hole.
    void refine(const std::vector<Point>& outside) {
        for (const Point& point : outside) seeds_.emplace_back(point.x(), point.y());
        refine_once();
        for (int round = 0; round < options_.optimize_iterations; ++round) smooth_once();
        if (options_.optimize_iterations > 0) refine_once();  // for edges that grew longer than allowed
        while (split_long_edges()) refine_once();
    }

    TriangleMesh mesh() { return domain_triangles(cdt_); }

private:
    void refine_once() {
        Mesher mesher(cdt_, criteria_);
        mesher.set_seeds(seeds_.begin(), seeds_.end(), false);
        mesher.init();
        switch (refine_domain(mesher, cdt_, static_cast<std::size_t>(options_.max_vertices))) {
            case Refinement::done: return;
            case Refinement::too_many: refuse_size(options_.max_vertices);
            case Refinement::in_vain: refuse_narrow();
        }
    }

    // Moves each vertex inside to the centroid of the triangles around it. CGAL's own Lloyd optimisation moves vertices
    // in the order of their addresses, which would make a mesh differ from run to run.
    void smooth_once() {
        std::vector<std::pair<Cdt::Vertex_handle, Cdt::Point>> moves;
        for (const Cdt::Vertex_handle vertex : cdt_.finite_vertex_handles()) {
            if (const auto centroid = centroid_around(vertex)) moves.emplace_back(vertex, *centroid);
        }
        for (const auto& [vertex, target] : moves) {
            cdt_.remove(vertex);
            cdt_.insert(target);
        }
        Mesher::mark_facets(cdt_, seeds_.begin(), seeds_.end(), false);
    }

    // None for vertices that must stay where they are.
    std::optional<Cdt::Point> centroid_around(Cdt::Vertex_handle vertex) const {
        if (cdt_.are_there_incident_constraints(vertex) || fixed_.contains(vertex)) return std::nullopt;
        double x = 0, y = 0, area = 0;
        Cdt::Face_circulator face = cdt_.incident_faces(vertex);
        const Cdt::Face_circulator last = face;
        do {
            if (cdt_.is_infinite(face) || !face->is_in_domain()) return std::nullopt;
            const Cdt::Point &a = face->vertex(0)->point(), &b = face->vertex(1)->point(),
                             &c = face->vertex(2)->point();
            const double weight = CGAL::area(a, b, c);
            x += weight * (a.x() + b.x() + c.x()) / 3;
            y += weight * (a.y() + b.y() + c.y()) / 3;
            area += weight;
        } while (++face != last);
        return Cdt::Point(x / area, y / area);
    }

    // The mesher spares triangles beside small input angles; the length is promised for those too.
    bool split_long_edges() {
        std::vector<std::pair<Cdt::Vertex_handle, Cdt::Vertex_handle>> fixed;
        std::vector<Cdt::Point> middles;
        for (const Cdt::Edge& edge : cdt_.finite_edges()) {
            const Cdt::Face_handle face = edge.first;
            if (!face->is_in_domain() && !face->neighbor(edge.second)->is_in_domain()) continue;
            const Cdt::Vertex_handle a = face->vertex(Cdt::cw(edge.second)), b = face->vertex(Cdt::ccw(edge.second));
            if (CGAL::squared_distance(a->point(), b->point()) <= max_edge_ * max_edge_) continue;
            if (cdt_.is_constrained(edge)) {
                fixed.emplace_back(a, b);
            } else {
                middles.push_back(CGAL::midpoint(a->point(), b->point()));
            }
        }
        for (const auto& [a, b] : fixed) {
            Cdt::Face_handle face;
            int side = 0;
            if (!cdt_.is_edge(a, b, face, side)) continue;
            cdt_.remove_constrained_edge(face, side);
            const Cdt::Vertex_handle middle = cdt_.insert(CGAL::midpoint(a->point(), b->point()));
            cdt_.insert_constraint(a, middle);
            cdt_.insert_constraint(middle, b);
        }
        for (const Cdt::Point& point : middles) cdt_.insert(point);
        if (cdt_.number_of_vertices() > static_cast<std::size_t>(options_.max_vertices)) {
            refuse_size(options_.max_vertices);
        }
        return !fixed.empty() || !middles.empty();
    }

    double max_edge_;
    const TriangulationOptions& options_;
    Criteria criteria_;
    Cdt cdt_;
    std::set<Cdt::Vertex_handle> fixed_;  // besides the ends of constraints; never walked through
    std::vector<Cdt::Point> seeds_;
};

}  // namespace

double default_max_edge_px(const Outline& outline) {
    Eigen::AlignedBox2d box;
    for (const OutlineComponent& component : outline.components) {
        for (const Point& point : component.outer) box.extend(point);
    }
    return box.isEmpty() ? 0 : box.diagonal().norm() / 60;
}

TriangleMesh triangulate(const Outline& outline, const std::vector<Polyline>& constraints,
                         const TriangulationOptions& options) {
    require_sound(options);
    const std::vector<Polyline> boundaries = sound_boundaries(outline);
    const double max_edge = options.max_edge_px > 0 ? options.max_edge_px : default_max_edge_px(outline);
    require_possible(outline, max_edge, options.max_vertices);

    std::vector<Point> in_holes;
    for (const OutlineComponent& component : outline.components) {
        for (const Polyline& hole : component.holes) {
            if (const auto point = point_in_hole(hole, boundaries)) in_holes.push_back(*point);
        }
    }
    try {
        MeshBuilder builder(max_edge, options);
        for (const Polyline& polygon : boundaries) builder.insert_polygon(polygon);
        const ClippedConstraints clipped = clipped_constraints(constraints, boundaries, 0.1 * max_edge);
        for (const Segment& s : clipped.segments) builder.insert_segment(s);
        for (const Point& point : clipped.points) builder.insert_point(point);
        builder.refine(in_holes);
        return builder.mesh();
    } catch (const CGAL::Failure_exception&) {
        // CGAL's checks found a triangle that round-off made flat.
        refuse_narrow();
    }
}

}  // namespace puppetwarp
