#include <puppetwarp/mesh/automatic_cage.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/mesh/bridges.h>
#include <puppetwarp/mesh/cage_shaper.h>
#include <puppetwarp/mesh/contour_field.h>
#include <puppetwarp/mesh/enclosing.h>
#include <puppetwarp/mesh/offset_field.h>
#include <puppetwarp/mesh/simplify.h>
#include <puppetwarp/mesh/triangle_sides.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <string>

namespace puppetwarp {

namespace {

// Everything is computed in the nodes of a grid, of which the subject's diagonal has so many.
constexpr double nodes_of_diagonal = 400;
// Places are rounded to this share of a node, so that a subject that was moved or scaled gives the same numbers.
constexpr double lattice = 65536;

// Lengths in nodes. The cage keeps `clearance` from the subject grown by `grown`; both together are the margin.
constexpr double grown = 3, clearance = 1, margin = grown + clearance;
// A corner that saves less than this, in square nodes, is worth nothing.
constexpr double worthless = 2 * margin * margin;

constexpr double degree = 0.017453292519943295;
constexpr CageRules rules{clearance, margin / 2, 10 * degree, margin};
// Of a cage made from the convex hull, which has sharp corners when it has few.
constexpr CageRules convex_rules{clearance, clearance, 1 * degree, margin};

// Between image space and nodes.
struct Frame {
    Point low;
    double node;  // px

    Point in_nodes(const Point& p) const {
        const Point q = (p - low) / node * lattice;
        return Point(std::round(q.x()), std::round(q.y())) / lattice;
    }
    Point in_image(const Point& q) const { return low + node * q; }
};

Frame frame_of(const std::vector<Strand>& strands) {
    Eigen::AlignedBox2d box;
    bool finite = true;
    for (const Strand& strand : strands) {
        for (const Point& p : strand.points) {
            finite = finite && p.allFinite();
            box.extend(p);
        }
    }
    const double diagonal = box.isEmpty() ? 0 : std::hypot(box.sizes().x(), box.sizes().y());
    // Squares of squares of what lies between are numbers.
    constexpr double smallest = 1e-70, largest = 1e70;
    if (!finite || !(diagonal < largest)) throw InvalidInput("cage", "the subject's coordinates are not all finite");
    if (!(diagonal > smallest)) throw InvalidInput("cage", "there is no subject to draw it around");
    return {box.min(), diagonal / nodes_of_diagonal};
}

// The outer boundary of all strands and what joins them, grown by `radius`.
// \param strands  in nodes, connected.
Polyline grown_boundary(const std::vector<Strand>& strands, double radius) {
    std::vector<GrownPolygon> polygons;
    Eigen::AlignedBox2d box;
    for (const Strand& strand : strands) {
        polygons.push_back({strand.points, std::vector<double>(strand.points.size(), radius)});
        for (const Point& p : strand.points) box.extend(p);
    }
    const double reach = radius + 3;
    const double x0 = std::floor(box.min().x() - reach), y0 = std::floor(box.min().y() - reach);
    ContourField field(x0, y0, static_cast<int>(std::ceil(box.max().x() + reach - x0)) + 1,
                       static_cast<int>(std::ceil(box.max().y() + reach - y0)) + 1);
    fill_offset(field, polygons);
    Polyline boundary;
    for (const Contour& contour : trace_contours(field)) {
        Polyline loop;
        for (const Crossing& crossing : contour) loop.push_back(crossing_point(field, crossing));
        if (boundary.empty() || signed_area(loop) > signed_area(boundary)) boundary = std::move(loop);
    }
    return boundary;
}

// With fewer corners, whose edges keep `clearance` where there is one.
Polyline thinned(const Polyline& boundary, double deviation, const Clearance* subject) {
    const auto blocked = [&](const Point& a, const Point& b) { return subject && !subject->keeps({a, b}, clearance); };
    return simplify({boundary}, deviation, blocked).front();
}

// A cage of at most so many corners, which there always is.
// \param hull  convex, at least `clearance` away from the subject.
Polyline convex_cage(const Clearance& subject, const Point& within, const Polyline& hull, std::size_t corners) {
    CageShaper merged(subject, within, convex_rules, hull);
    const bool few_enough = merged.reduce(corners, worthless);
    merged.settle();
    if (corners > 3 && few_enough) return merged.polygon();
    const auto cost = [](const Polyline& polygon) { return cage_cost(polygon, convex_rules); };
    CageShaper triangle(subject, within, convex_rules, enclosing_triangle(hull, cost));
    triangle.settle();
    return few_enough && merged.cost() <= triangle.cost() ? merged.polygon() : triangle.polygon();
}

// The cheapest cage of at most so many corners.
// \param start  a cage of many.
Polyline cheapest_cage(const Clearance& subject, const Point& within, const Polyline& start, std::size_t corners) {
    const Polyline convex = convex_cage(subject, within, convex_hull(start), corners);
    CageShaper close(subject, within, rules, start);
    const bool few_enough = close.reduce(corners, worthless);
    if (few_enough) {
        close.settle();
        close.refine(corners, worthless);
        if (close.cost() <= cage_cost(convex, rules)) return close.polygon();
    }
    CageShaper refined(subject, within, convex_rules, convex);
    refined.refine(corners, worthless);
    return refined.polygon();
}

// The same polygon with exactly so many corners: edges are divided evenly, so that the longest pieces are as short as
// can be.
Polyline divided(const Polyline& polygon, std::size_t corners) {
    std::vector<std::size_t> pieces(polygon.size(), 1);
    const auto length = [&](std::size_t k) {
        return (polygon[(k + 1) % polygon.size()] - polygon[k]).norm() / static_cast<double>(pieces[k]);
    };
    for (std::size_t n = polygon.size(); n < corners; ++n) {
        std::size_t longest = 0;
        for (std::size_t k = 1; k < polygon.size(); ++k) {
            if (length(k) > length(longest)) longest = k;
        }
        ++pieces[longest];
    }
    Polyline result;
    for (std::size_t k = 0; k < polygon.size(); ++k) {
        const Point &a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
        for (std::size_t piece = 0; piece < pieces[k]; ++piece) {
            result.push_back(a + static_cast<double>(piece) / static_cast<double>(pieces[k]) * (b - a));
        }
    }
    return result;
}

void begin_at_the_top(Polyline& polygon) {
    const auto top = std::min_element(polygon.begin(), polygon.end(), [](const Point& a, const Point& b) {
        return a.y() != b.y() ? a.y() < b.y() : a.x() < b.x();
    });
    std::rotate(polygon.begin(), top, polygon.end());
}

Polyline cage_around(std::vector<Strand> strands, int corners) {
    if (corners < fewest_cage_corners || corners > most_cage_corners) {
        throw InvalidInput(
            "cage", "cannot have " + std::to_string(corners) + " corners",
            "choose " + std::to_string(fewest_cage_corners) + " to " + std::to_string(most_cage_corners));
    }
    const Frame frame = frame_of(strands);
    for (Strand& strand : strands) {
        for (Point& p : strand.points) p = frame.in_nodes(p);
    }
    for (const Segment& bridge : bridges(strands)) strands.push_back({{bridge.a, bridge.b}, 0});
    const Clearance subject(thinned(grown_boundary(strands, grown), 0.1, nullptr));
    constexpr double roughness = 0.5;  // of the first cage
    const Polyline start = thinned(grown_boundary(strands, margin + roughness + 0.3), roughness, &subject);
    const Point within = strands.front().points.front();
    Polyline cage = divided(cheapest_cage(subject, within, start, static_cast<std::size_t>(corners)),
                            static_cast<std::size_t>(corners));
    for (Point& corner : cage) corner = frame.in_image(corner);
    begin_at_the_top(cage);
    return cage;
}

}  // namespace

Polyline automatic_cage(const Outline& outline, int corners) {
    std::vector<Strand> strands;
    int component = 0;
    for (const OutlineComponent& part : outline.components) {
        if (part.outer.empty()) continue;
        strands.push_back({part.outer, component});
        for (const Polyline& hole : part.holes) {
            if (!hole.empty()) strands.push_back({hole, component});
        }
        ++component;
    }
    return cage_around(std::move(strands), corners);
}

Polyline automatic_cage(const TriangleMesh& mesh, int corners) {
    const Eigen::VectorXi component = vertex_components(mesh);
    std::vector<Strand> strands;
    for (const auto& [a, b] : boundary_edges(mesh)) {
        strands.push_back({{mesh.V.row(a).transpose(), mesh.V.row(b).transpose()}, component(a)});
    }
    return cage_around(std::move(strands), corners);
}

}  // namespace puppetwarp
