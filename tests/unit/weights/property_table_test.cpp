// What the literature judges families of weights by (Jacobson, Baran, Popovic & Sorkine 2011; Jacobson, Weinkauf &
// Sorkine 2012), as a table whose every cell is a test: where it says yes, the property holds on all seeded scenes to a
// tolerance; where it says no, one of them is a counterexample by far. README.md shows the same table.

#include "cages.h"
#include "reference/test_meshes.h"

#include <puppetwarp/base/errors.h>
#include <puppetwarp/mesh/locate.h>
#include <puppetwarp/mesh/operators.h>
#include <puppetwarp/mesh/triangulate.h>
#include <puppetwarp/weights/monotonic.h>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <numeric>

namespace puppetwarp {

using namespace tests;

namespace {

struct Family {
    std::string name;
    WeightKind kind;
    bool cage;  // of a cage alone; else of points and bones
};

class Random {
public:
    explicit Random(std::uint32_t seed) : engine_(seed) {}
    double between(double low, double high) { return low + (high - low) * (engine_() / 4294967296.0); }
    //! Places in a rectangle, apart from each other and from its sides.
    std::vector<Point> places(int count, const Point& size, double margin, double apart) {
        std::vector<Point> found;
        while (static_cast<int>(found.size()) < count) {
            const double x = between(margin, size.x() - margin);
            const Point p(x, between(margin, size.y() - margin));
            if (std::all_of(found.begin(), found.end(), [&](const Point& q) { return (p - q).norm() > apart; })) {
                found.push_back(p);
            }
        }
        return found;
    }

private:
    std::mt19937 engine_;
};

struct Scene {
    TriangleMesh mesh;
    Rig rig;
};

// The handles' places are vertices and edges of the mesh.
Scene scene_of(const Polyline& outline, const std::vector<Handle>& handles, double edge) {
    std::vector<Polyline> constraints;
    for (const Handle& handle : handles) {
        if (const auto* point = std::get_if<PointHandle>(&handle.shape)) constraints.push_back({point->at});
        if (const auto* bone = std::get_if<BoneHandle>(&handle.shape)) constraints.push_back({bone->from, bone->to});
        if (const auto* cage = std::get_if<CageHandle>(&handle.shape)) {
            constraints.push_back(cage->points);
            constraints.back().push_back(cage->points.front());
        }
    }
    return {triangulate({{{outline, {}}}}, constraints, {edge}), {handles, {}}};
}

// A mesh that fills its cage.
Scene caged(const Polyline& cage, double edge) {
    return {triangulate({{{cage, {}}}}, {}, {edge}), {{cage_handle("hull", cage)}, {}}};
}

std::vector<Handle> points_at(const std::vector<Point>& places) {
    return reference::rig_of_points(places).handles;
}

Weights weights_of(const Family& family, const Scene& scene) {
    Progress progress;
    Weights found = compute_weights(scene.mesh, scene.rig, {.kind = family.kind}, progress);
    EXPECT_TRUE(found.converged);
    return found;
}

// Real parts, then imaginary ones.
Eigen::MatrixXd all_parts(const Weights& weights) {
    Eigen::MatrixXd all(weights.W.rows(), weights.W.cols() + weights.W_imaginary.cols());
    all.leftCols(weights.W.cols()) = weights.W;
    if (weights.W_imaginary.size() > 0) all.rightCols(weights.W_imaginary.cols()) = weights.W_imaginary;
    return all;
}

Eigen::MatrixXd magnitudes(const Weights& weights) {
    if (weights.W_imaginary.size() == 0) return weights.W.cwiseAbs();
    return (weights.W.array().square() + weights.W_imaginary.array().square()).sqrt();
}

// Where a point lies on a polygon's edges, to round-off: edge and share of the way along it.
std::optional<std::pair<std::size_t, double>> place_on(const Polyline& polygon, const Point& p) {
    for (std::size_t k = 0; k < polygon.size(); ++k) {
        const Point &a = polygon[k], along = polygon[(k + 1) % polygon.size()] - a;
        const double share = std::clamp(along.dot(p - a) / along.squaredNorm(), 0.0, 1.0);
        if ((a + share * along - p).norm() < 1e-7) return {{k, share}};
    }
    return std::nullopt;
}

// What one vertex must have of each column, where a handle holds it.
std::optional<Eigen::RowVectorXd> held_row(const Scene& scene, const std::vector<WeightColumn>& columns, int vertex) {
    const Point p = scene.mesh.V.row(vertex).transpose();
    Eigen::RowVectorXd row = Eigen::RowVectorXd::Zero(static_cast<Eigen::Index>(columns.size()));
    bool held = false;
    for (std::size_t c = 0; c < columns.size(); ++c) {
        const auto& shape = scene.rig.handles[static_cast<std::size_t>(columns[c].handle)].shape;
        double share = 0;
        if (const auto* cage = std::get_if<CageHandle>(&shape)) {
            const auto place = place_on(cage->points, p);
            if (!place) continue;
            held = true;
            const auto corner = static_cast<std::size_t>(columns[c].corner);
            if (corner == place->first) share = 1 - place->second;
            if (corner == (place->first + 1) % cage->points.size()) share = place->second;
        } else if (const auto* point = std::get_if<PointHandle>(&shape)) {
            share = (point->at - p).norm() < 1e-7 ? 1 : 0;
        } else if (const auto* bone = std::get_if<BoneHandle>(&shape)) {
            share = place_on({bone->from, bone->to}, p) ? 1 : 0;
        } else if (const auto* region = std::get_if<RegionHandle>(&shape)) {
            const Polyline& r = region->points;  // a rectangle
            share = p.x() > r[0].x() && p.x() < r[2].x() && p.y() > r[0].y() && p.y() < r[2].y() ? 1 : 0;
        }
        held |= share > 0;
        row(static_cast<Eigen::Index>(c)) = share;
    }
    if (!held) return std::nullopt;
    return row;
}

Scene open_scene(const Family& family, std::uint32_t seed) {
    constexpr double edge = 8;
    Random random(seed);
    if (family.cage) return caged(star({100, 100}, 12, 22, 98, seed), edge);
    const Polyline outline = star({100, 100}, 40, 80, 92, seed);
    return scene_of(outline, points_at(random.places(7, {200, 200}, 45, 22)), edge);
}

// C1: the largest jump of a gradient across an edge falls as the mesh is refined. Functions of least Laplacian energy
// end at a bone's tip like r^(3/2), where neighbours' gradients differ by the root of an edge's length: a quarter of
// the edge length halves the jump. A crease keeps it, and harmonic functions at points make it grow. Cages: away from
// their corners.
double jump_left_after_refining(const Family& family, std::uint32_t seed) {
    Random random(seed);
    std::vector<Handle> handles = points_at(random.places(2, {60, 100}, 15, 30));
    const Point from(random.between(80, 100), random.between(30, 50));
    handles.push_back({"bone", BoneHandle{from, from + Point(25, random.between(0, 20)), ""}});
    const Polyline cage = star({70, 70}, 8, 40, 65, seed);
    const auto largest_jump = [&](double edge) {
        const Scene scene =
            family.cage ? caged(cage, edge) : scene_of({{0, 0}, {140, 0}, {140, 100}, {0, 100}}, handles, edge);
        const Eigen::MatrixXcd W = all_parts(weights_of(family, scene)).cast<Complex>();
        const Eigen::MatrixX3cd G = hat_gradients(scene.mesh);
        const auto gradient = [&](Eigen::Index t) {
            Eigen::RowVectorXcd g = Eigen::RowVectorXcd::Zero(W.cols());
            for (int k = 0; k < 3; ++k) g += G(t, k) * W.row(scene.mesh.F(t, k));
            return g;
        };
        double largest = 0;
        std::map<std::pair<int, int>, Eigen::Index> first;
        for (Eigen::Index t = 0; t < scene.mesh.F.rows(); ++t) {
            for (int k = 0; k < 3; ++k) {
                const std::pair<int, int> e = std::minmax(scene.mesh.F(t, k), scene.mesh.F(t, (k + 1) % 3));
                const auto [other, alone] = first.try_emplace(e, t);
                const Point middle = (scene.mesh.V.row(e.first) + scene.mesh.V.row(e.second)).transpose() / 2;
                const auto near = [&](const Point& corner) { return (corner - middle).norm() < 10; };
                if (alone || (family.cage && std::any_of(cage.begin(), cage.end(), near))) continue;
                largest = std::max(largest, (gradient(t) - gradient(other->second)).cwiseAbs().maxCoeff());
            }
        }
        return largest;
    };
    return largest_jump(4) / largest_jump(16);
}

double least_below_zero(const Family& family, std::uint32_t seed) {
    return -weights_of(family, open_scene(family, seed)).W.minCoeff();
}

// Two fingers close to each other: what lies across the slit is far away inside the shape. How much the tip of one
// hears of the tip of the other, whose handles are a point, or two corners of a cage around both.
double heard_across_a_slit(const Family& family, std::uint32_t seed) {
    Random random(seed);
    const double slit = random.between(1, 3), finger = random.between(14, 20), other = finger + slit;
    const double length = 100, width = 2 * finger + slit;
    const Polyline outline{{0, 0},     {finger, 0}, {finger, length},     {other, length},
                           {other, 0}, {width, 0},  {width, length + 30}, {0, length + 30}};
    const Scene scene =
        family.cage
            ? caged(outline, 4)
            : scene_of(outline,
                       points_at({{finger / 2, 8}, {width / 2, length + 15}, {other + finger / 2, length / 2}}), 4);
    const Eigen::MatrixXd W = magnitudes(weights_of(family, scene));
    const int tip = reference::nearest_vertex(scene.mesh, {other + finger / 2, 8});
    return family.cage ? W(tip, 0) + W(tip, 1) : W(tip, 0);
}

// A strip with handles all along, or corners of a cage: the largest weight of the first behind the fifth.
double heard_behind_others(const Family& family, std::uint32_t seed) {
    const double width = Random(seed).between(16, 30);
    std::vector<Point> middle;
    Polyline cage;
    for (int k = 0; k < 10; ++k) middle.emplace_back(20 + 40 * k, width / 2);
    for (int k = 0; k <= 10; ++k) cage.emplace_back(40 * k, 0);
    for (int k = 10; k >= 0; --k) cage.emplace_back(40 * k, width);
    const Scene scene =
        family.cage ? caged(cage, 5) : scene_of({{0, 0}, {400, 0}, {400, width}, {0, width}}, points_at(middle), 5);
    const Eigen::MatrixXd W = magnitudes(weights_of(family, scene));
    double heard = 0;
    for (Eigen::Index v = 0; v < W.rows(); ++v) {
        if (scene.mesh.V(v, 0) > 181) heard = std::max(heard, W(v, 0));
    }
    return heard;
}

// The largest persistence of a maximum that is not held: how far one has to step down from it to reach a higher one
// (Edelsbrunner, Letscher & Zomorodian 2002).
double highest_loose_maximum(const Scene& scene, const std::vector<char>& held, const Eigen::VectorXd& w) {
    const auto count = static_cast<std::size_t>(w.size());
    std::vector<std::vector<std::size_t>> neighbours(count);
    for (Eigen::Index t = 0; t < scene.mesh.F.rows(); ++t) {
        for (int k = 0; k < 6; ++k) {
            neighbours[static_cast<std::size_t>(scene.mesh.F(t, k % 3))].push_back(
                static_cast<std::size_t>(scene.mesh.F(t, (k % 3 + 1 + k / 3) % 3)));
        }
    }
    const auto height = [&](std::size_t v) { return w(static_cast<Eigen::Index>(v)); };
    // From above: of two at one height the held one comes first, and is the top of what they join.
    std::vector<std::size_t> order(count), place(count), parent(count, count);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return std::tuple(height(a), held[a], b) > std::tuple(height(b), held[b], a);
    });
    for (std::size_t k = 0; k < count; ++k) place[order[k]] = k;
    const auto top = [&](std::size_t v) {
        while (parent[v] != v) v = parent[v] = parent[parent[v]];
        return v;
    };
    double highest = held[order.front()] ? 0 : w.maxCoeff() - w.minCoeff();
    for (const std::size_t v : order) {
        parent[v] = v;
        for (const std::size_t u : neighbours[v]) {
            if (parent[u] == count) continue;
            std::size_t a = top(u), b = top(v);
            if (a == b) continue;
            if (place[a] > place[b]) std::swap(a, b);
            if (!held[b]) highest = std::max(highest, height(b) - height(v));
            parent[b] = a;
        }
    }
    return highest;
}

double highest_loose_extremum(const Scene& scene, const Eigen::MatrixXd& W, const std::vector<WeightColumn>& columns) {
    std::vector<char> held;
    for (int v = 0; v < W.rows(); ++v) held.push_back(held_row(scene, columns, v).has_value());
    double highest = 0;
    for (Eigen::Index j = 0; j < W.cols(); ++j) {
        highest = std::max(
            {highest, highest_loose_maximum(scene, held, W.col(j)), highest_loose_maximum(scene, held, -W.col(j))});
    }
    return highest;
}

// Extrema away from handles; cages also within a larger subject. Of `monotonic` before rows are divided by their sums.
double loose_extremum(const Family& family, std::uint32_t seed) {
    Scene scene = open_scene(family, seed);
    if (family.kind == WeightKind::monotonic) {
        Progress progress;
        const WeightProblem problem(scene.mesh, scene.rig);
        return highest_loose_extremum(scene, monotonic_functions(problem, {}, progress).W, problem.conditions.columns);
    }
    const auto highest = [&] {
        const Weights weights = weights_of(family, scene);
        return highest_loose_extremum(scene, all_parts(weights), weights.columns);
    };
    const double found = highest();
    if (!family.cage) return found;
    const Handle inner = cage_handle("hull", star({100, 100}, 8, 30, 60, seed));
    scene = scene_of({{0, 0}, {200, 0}, {200, 200}, {0, 200}}, {inner}, 8);
    return std::max(found, highest());
}

double missed_by_handles(const Family& family, const Scene& scene) {
    const Weights weights = weights_of(family, scene);
    double most = 0;
    int held = 0;
    for (int v = 0; v < scene.mesh.V.rows(); ++v) {
        const auto row = held_row(scene, weights.columns, v);
        if (!row) continue;
        ++held;
        most = std::max(most, (weights.W.row(v) - *row).cwiseAbs().maxCoeff());
    }
    EXPECT_GE(held, 7);
    return most;
}

double missed_by_own_handles(const Family& family, std::uint32_t seed) {
    return missed_by_handles(family, open_scene(family, seed));
}

// Two points, a bone, a region and a cage in one solve; 1 where that is refused.
double missed_by_mixed_handles(const Family& family, std::uint32_t seed) {
    Random random(seed);
    std::vector<Handle> handles = points_at({{20, random.between(20, 120)}, {180, random.between(20, 60)}});
    handles.push_back({"bone", BoneHandle{{50, random.between(20, 40)}, {110, 30}, ""}});
    const double y = random.between(70, 90);
    handles.push_back({"region", RegionHandle{{{50, y}, {80, y}, {80, y + 30}, {50, y + 30}}, Falloff::none}});
    handles.push_back(cage_handle("hull", star({150, 95}, 6, 20, 35, seed)));
    try {
        return missed_by_handles(family, scene_of({{0, 0}, {200, 0}, {200, 140}, {0, 140}}, handles, 8));
    } catch (const InvalidInput&) {
        return 1;
    }
}

double missing_from_one(const Family& family, std::uint32_t seed) {
    const Weights weights = weights_of(family, open_scene(family, seed));
    double most = (weights.W.rowwise().sum().array() - 1).abs().maxCoeff();
    if (weights.W_imaginary.size() > 0) {
        most = std::max(most, weights.W_imaginary.rowwise().sum().cwiseAbs().maxCoeff());
    }
    return most;
}

// Handles at rest take each vertex to its place, which makes them reproduce what maps their places linearly (`cauchy`:
// similarities). A share of the diagonal.
double off_its_place(const Family& family, std::uint32_t seed) {
    const Scene scene = open_scene(family, seed);
    const Weights weights = weights_of(family, scene);
    Polyline places;
    for (const WeightColumn& column : weights.columns) {
        const auto& shape = scene.rig.handles[static_cast<std::size_t>(column.handle)].shape;
        const auto* cage = std::get_if<CageHandle>(&shape);
        places.push_back(cage != nullptr ? cage->points[static_cast<std::size_t>(column.corner)]
                                         : std::get<PointHandle>(shape).at);
    }
    const Eigen::MatrixX2d off = moved_by(weights, places) - scene.mesh.V;
    return off.rowwise().norm().maxCoeff() / bounding_diagonal(scene.mesh.V);
}

struct Property {
    std::string name;
    double (*measure)(const Family&, std::uint32_t seed);
    double most;   // of what holds
    double clear;  // a counterexample has at least this
};

const std::vector<Property>& properties() {
    static const std::vector<Property> all{
        {"Smooth", jump_left_after_refining, 0.8, 1.2},  {"NonNegative", least_below_zero, 1e-12, 1e-2},
        {"ShapeAware", heard_across_a_slit, 0.05, 0.2},  {"Local", heard_behind_others, 1e-6, 1e-4},
        {"Monotonic", loose_extremum, 1e-6, 1e-3},       {"ForAnyHandles", missed_by_mixed_handles, 1e-12, 1},
        {"SummingToOne", missing_from_one, 1e-9, 1e-3},  {"Interpolating", missed_by_own_handles, 1e-12, 0.1},
        {"LinearlyPrecise", off_its_place, 1e-10, 1e-3},
    };
    return all;
}

constexpr bool yes = true, no = false;

struct Row {
    Family family;
    std::array<bool, 9> has;  // in the order of `properties`
};

// clang-format off
const std::vector<Row>& table() {
    static const std::vector<Row> all{
        //                                              smooth  aware   monot.  sums to 1    linear
        //                                                >= 0   local  any handles  interpolates
        {{"shepard", WeightKind::shepard, false},             {yes, yes, no,  no,  no,  yes, yes, yes, no}},
        {{"harmonic", WeightKind::harmonic, false},           {no,  yes, yes, no,  yes, yes, yes, yes, no}},
        {{"biharmonic", WeightKind::biharmonic, false},       {yes, no,  yes, no,  no,  yes, yes, yes, no}},
        {{"bbw", WeightKind::bbw, false},                     {yes, yes, yes, yes, no,  yes, yes, yes, no}},
        {{"l1", WeightKind::l1, false},                       {yes, yes, yes, yes, no,  yes, yes, yes, no}},
        {{"monotonic", WeightKind::monotonic, false},         {yes, yes, yes, yes, yes, yes, yes, yes, no}},
        {{"mean_value", WeightKind::mean_value, true},        {yes, no,  no,  no,  no,  no,  yes, yes, yes}},
        {{"harmonic_cage", WeightKind::harmonic_cage, true},  {yes, yes, yes, yes, yes, yes, yes, yes, yes}},
        {{"cauchy", WeightKind::cauchy, true},                {yes, no,  no,  no,  no,  no,  yes, no,  yes}},
        {{"bbw_on_a_cage", WeightKind::bbw, true},            {yes, yes, yes, yes, no,  yes, yes, yes, no}},
    };
    return all;
}
// clang-format on

struct Cell {
    const Family& family;
    const Property& property;
    bool holds;
};

std::vector<Cell> cells() {
    std::vector<Cell> all;
    for (const Row& row : table()) {
        for (std::size_t p = 0; p < properties().size(); ++p) {
            all.push_back({row.family, properties()[p], row.has[p]});
        }
    }
    return all;
}

class PropertyTable : public testing::TestWithParam<Cell> {};

TEST_P(PropertyTable, Says) {
    const auto& [family, property, holds] = GetParam();
    double worst = 0;
    for (std::uint32_t seed = 1; seed <= 3; ++seed) {
        const double measured = property.measure(family, seed);
        if (holds) {
            EXPECT_LE(measured, property.most) << "seed " << seed;
        }
        worst = std::max(worst, measured);
    }
    if (!holds) {
        EXPECT_GE(worst, property.clear) << "there is no counterexample";
    }
}

INSTANTIATE_TEST_SUITE_P(Cells, PropertyTable, testing::ValuesIn(cells()), [](const auto& cell) {
    return cell.param.family.name + (cell.param.holds ? "_Is" : "_IsNot") + cell.param.property.name;
});

// What dividing rows by their sums takes from `monotonic` weights.
TEST(MonotonicWeights, HaveButSmallExtremaAfterTheDivision) {
    const Family family{"monotonic", WeightKind::monotonic, false};
    for (std::uint32_t seed = 1; seed <= 3; ++seed) {
        const Scene scene = open_scene(family, seed);
        const Weights weights = weights_of(family, scene);
        EXPECT_LT(highest_loose_extremum(scene, weights.W, weights.columns), 0.02);
    }
}

}  // namespace
}  // namespace puppetwarp
