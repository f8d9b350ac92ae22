#include <puppetwarp/mesh/bridges.h>

#include <puppetwarp/mesh/constrained_triangles.h>

#include <algorithm>
#include <numeric>
#include <tuple>

namespace puppetwarp {

namespace {

class Components {
public:
    explicit Components(int count) : parent_(static_cast<std::size_t>(count)) {
        std::iota(parent_.begin(), parent_.end(), 0);
    }
    int of(int component) {
        while (parent(component) != component) {
            parent(component) = parent(parent(component));
            component = parent(component);
        }
        return component;
    }
    // \return whether they were apart.
    bool join(int a, int b) {
        const int one = of(a), other = of(b);
        parent(std::max(one, other)) = std::min(one, other);
        return one != other;
    }

private:
    int& parent(int component) { return parent_[static_cast<std::size_t>(component)]; }
    std::vector<int> parent_;
};

}  // namespace

std::vector<Segment> bridges(const std::vector<Strand>& strands) {
    int count = 0;
    for (const Strand& strand : strands) count = std::max(count, strand.component + 1);
    if (count < 2) return {};
    Components components(count);
    Cdt triangles;
    Cdt::Face_handle near;
    for (const Strand& strand : strands) {
        for (const Point& p : strand.points) {
            const std::size_t before = triangles.number_of_vertices();
            const Cdt::Vertex_handle vertex = triangles.insert({p.x(), p.y()}, near);
            near = vertex->face();
            if (triangles.number_of_vertices() > before) vertex->info() = strand.component;
            components.join(vertex->info(), strand.component);
        }
    }
    using Link = std::tuple<double, double, double, Segment, int, int>;
    std::vector<Link> links;
    for (const Cdt::Edge& edge : triangles.finite_edges()) {
        const Cdt::Vertex_handle a = edge.first->vertex(Cdt::cw(edge.second)),
                                 b = edge.first->vertex(Cdt::ccw(edge.second));
        const Segment s{{a->point().x(), a->point().y()}, {b->point().x(), b->point().y()}};
        const Point middle = 0.5 * (s.a + s.b);
        if (components.of(a->info()) != components.of(b->info())) {
            links.emplace_back((s.b - s.a).norm(), middle.x(), middle.y(), s, a->info(), b->info());
        }
    }
    // Links of one length go by place, not by the triangulation's order.
    std::sort(links.begin(), links.end(), [](const Link& a, const Link& b) {
        return std::tie(std::get<0>(a), std::get<1>(a), std::get<2>(a)) <
               std::tie(std::get<0>(b), std::get<1>(b), std::get<2>(b));
    });
    std::vector<Segment> chosen;
    for (const auto& [length, x, y, segment, a, b] : links) {
        if (components.join(a, b)) chosen.push_back(segment);
    }
    return chosen;
}

}  // namespace puppetwarp
