#include <puppetwarp/weights/coarse_levels.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/mesh/locate.h>
#include <puppetwarp/mesh/simplify.h>
#include <puppetwarp/mesh/triangulate.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <utility>

namespace puppetwarp {

namespace {

// Smaller meshes are solved at once.
constexpr Eigen::Index small_mesh = 600;
// Of the wanted mean edge: the longest that makes the mesher's mean what is wanted, and how far the outline may move.
constexpr double longest_share = 1.5;
constexpr double deviation_share = 0.2;

// Length of the edges of equilateral triangles of the mesh's mean area.
double mean_edge(const TriangleMesh& mesh) {
    return std::sqrt(2 / std::numbers::sqrt3 * double_areas(mesh.V, mesh.F).cwiseAbs().mean());
}

// Which triangles hang together by their edges, 0-based.
class TrianglePieces {
public:
    explicit TrianglePieces(std::size_t triangles) : parent_(triangles) {
        for (std::size_t t = 0; t < triangles; ++t) parent_[t] = t;
    }
    std::size_t piece(std::size_t t) {
        while (parent_[t] != t) t = parent_[t] = parent_[parent_[t]];
        return t;
    }
    void join(std::size_t a, std::size_t b) { parent_[piece(a)] = piece(b); }

private:
    std::vector<std::size_t> parent_;
};

struct BoundaryEdge {
    int to;
    std::size_t triangle;
};

// The boundary of a mesh as closed loops with the inside on their left as the triangles have it; each with a triangle
// beside it.
class BoundaryLoops {
public:
    explicit BoundaryLoops(const TriangleMesh& mesh)
        : mesh_(mesh),
          pieces_(static_cast<std::size_t>(mesh.F.rows())),
          positive_(double_areas(mesh.V, mesh.F)(0) > 0) {
        std::map<std::pair<int, int>, std::size_t> open;  // directed edges without a partner so far
        for (Eigen::Index t = 0; t < mesh.F.rows(); ++t) {
            for (int k = 0; k < 3; ++k) {
                std::pair<int, int> edge(corner(t, k), corner(t, k + 1));
                const auto partner = open.find({edge.second, edge.first});
                if (partner == open.end()) {
                    open.emplace(edge, static_cast<std::size_t>(t));
                } else {
                    pieces_.join(partner->second, static_cast<std::size_t>(t));
                    open.erase(partner);
                }
            }
        }
        for (const auto& [edge, triangle] : open) after_[edge.first].push_back({edge.second, triangle});
    }

    // Pieces in the order of their first boundary vertex. None where a loop could not be told from another.
    std::optional<Outline> outline() {
        std::map<std::size_t, OutlineComponent> components;
        while (!after_.empty()) {
            const std::size_t piece = pieces_.piece(after_.begin()->second.front().triangle);
            const Polyline loop = take_loop(after_.begin()->first);
            if (loop.size() < 4) return std::nullopt;
            OutlineComponent& component = components[piece];
            if (signed_area(loop) < 0) {
                component.holes.push_back(loop);
            } else if (component.outer.empty()) {
                component.outer = loop;
            } else {
                return std::nullopt;
            }
        }
        Outline outline;
        for (auto& [piece, component] : components) {
            if (component.outer.empty()) return std::nullopt;
            outline.components.push_back(std::move(component));
        }
        return outline;
    }

private:
    int corner(Eigen::Index t, int k) const { return mesh_.F(t, positive_ ? k % 3 : (3 - k % 3) % 3); }

    // A vertex where the boundary passes twice is left by an edge of the triangles by which it was reached, so that
    // loops meet there but do not cross.
    Polyline take_loop(int first) {
        Polyline loop;
        int at = first;
        std::optional<std::size_t> piece;
        do {
            auto& choices = after_.at(at);
            auto next = choices.begin();
            if (piece) {
                next = std::find_if(choices.begin(), choices.end(),
                                    [&](const BoundaryEdge& e) { return pieces_.piece(e.triangle) == *piece; });
                if (next == choices.end()) return {};
            }
            piece = pieces_.piece(next->triangle);
            loop.emplace_back(mesh_.V.row(at).transpose());
            const int to = next->to;
            choices.erase(next);
            if (choices.empty()) after_.erase(at);
            at = to;
        } while (at != first);
        return loop;
    }

    const TriangleMesh& mesh_;
    TrianglePieces pieces_;
    bool positive_;
    std::map<int, std::vector<BoundaryEdge>> after_;
};

// The loops of an outline, thinned out together so that they stay apart.
Outline thinned(const Outline& outline, double deviation) {
    std::vector<Polyline> loops;
    for (const OutlineComponent& component : outline.components) {
        loops.push_back(component.outer);
        loops.insert(loops.end(), component.holes.begin(), component.holes.end());
    }
    std::vector<Polyline> thin = simplify(loops, deviation, [](const Point&, const Point&) { return false; });
    Outline result;
    std::size_t next = 0;
    for (const OutlineComponent& component : outline.components) {
        OutlineComponent& made = result.components.emplace_back();
        made.outer = std::move(thin[next++]);
        for (std::size_t hole = 0; hole < component.holes.size(); ++hole) made.holes.push_back(std::move(thin[next++]));
    }
    return result;
}

// What handles hold of `fine`, moved to the nearest vertices of `coarse`; where several meet, their mean.
// None where a component of the coarse mesh is left without.
std::optional<WeightConditions> moved(const WeightConditions& conditions, const TriangleMesh& fine,
                                      const TriangleMesh& coarse) {
    const MeshLocator locator(coarse);
    const Eigen::Index columns = conditions.values.cols();
    std::map<int, std::pair<Eigen::RowVectorXd, int>> sums;
    for (std::size_t i = 0; i < conditions.vertices.size(); ++i) {
        const MeshLocation place = locator.locate(fine.V.row(conditions.vertices[i]).transpose());
        Eigen::Index corner = 0;
        place.barycentric.maxCoeff(&corner);
        auto& [sum, count] =
            sums.try_emplace(coarse.F(place.triangle, corner), Eigen::RowVectorXd::Zero(columns), 0).first->second;
        sum += conditions.values.row(static_cast<Eigen::Index>(i));
        ++count;
    }
    const Eigen::VectorXi component = vertex_components(coarse);
    std::vector<char> held(static_cast<std::size_t>(component.maxCoeff()) + 1, 0);
    WeightConditions result;
    result.columns = conditions.columns;
    result.values.resize(static_cast<Eigen::Index>(sums.size()), columns);
    for (const auto& [vertex, mean] : sums) {
        result.values.row(static_cast<Eigen::Index>(result.vertices.size())) = mean.first / mean.second;
        result.vertices.push_back(vertex);
        held[static_cast<std::size_t>(component(vertex))] = 1;
    }
    if (std::find(held.begin(), held.end(), 0) != held.end()) return std::nullopt;
    return result;
}

SparseMatrix carry_to(const TriangleMesh& fine, const TriangleMesh& coarse) {
    const MeshLocator locator(coarse);
    std::vector<Eigen::Triplet<double>> entries;
    for (int v = 0; v < fine.V.rows(); ++v) {
        const MeshLocation place = locator.locate(fine.V.row(v).transpose());
        for (int k = 0; k < 3; ++k) entries.emplace_back(v, coarse.F(place.triangle, k), place.barycentric(k));
    }
    SparseMatrix carry(fine.V.rows(), coarse.V.rows());
    carry.setFromTriplets(entries.begin(), entries.end());
    return carry;
}

}  // namespace

std::vector<CoarseLevel> coarse_levels(const WeightProblem& problem) {
    std::vector<CoarseLevel> levels;
    if (problem.mesh.V.rows() < small_mesh) return levels;
    const std::optional<Outline> outline = BoundaryLoops(problem.mesh).outline();
    if (!outline) return levels;
    const TriangleMesh* finer = &problem.mesh;
    for (double edge = 2 * mean_edge(problem.mesh); finer->V.rows() >= small_mesh; edge *= 2) {
        TriangulationOptions options;
        options.max_edge_px = longest_share * edge;
        TriangleMesh mesh;
        try {
            mesh = triangulate(thinned(*outline, deviation_share * edge), {}, options);
        } catch (const InvalidInput&) {
            break;  // too coarse for this outline
        }
        if (2 * mesh.V.rows() > finer->V.rows()) break;
        std::optional<WeightConditions> conditions = moved(problem.conditions, problem.mesh, mesh);
        if (!conditions) break;
        SparseMatrix carry = carry_to(*finer, mesh);
        levels.push_back({WeightProblem(mesh, problem.rig, std::move(*conditions)), std::move(carry)});
        finer = &levels.back().problem.mesh;
    }
    return levels;
}

}  // namespace puppetwarp
