// Weights of ten handles, seven points and three bones, on a figure, and of a cage of twenty corners around it; and the
// factor of its Laplacian beside them.

#include "reference/test_meshes.h"

#include <puppetwarp/rig/add_cage.h>
#include <puppetwarp/solve/cholesky.h>
#include <puppetwarp/weights/weight_problem.h>

#include <benchmark/benchmark.h>

namespace puppetwarp {
namespace {

namespace places = reference::figure_places;

constexpr double size_px = 1000;

const TriangleMesh& figure_of(int vertices) {
    static const TriangleMesh small = reference::figure(size_px, 8.6), large = reference::figure(size_px, 4.3);
    return vertices < 10000 ? small : large;
}

Rig ten_handles() {
    Rig rig = reference::rig_of_points(
        {size_px * places::head, size_px * places::left_hand, size_px * places::right_hand, size_px * places::left_foot,
         size_px * places::right_foot, size_px * places::right_shoulder, size_px * Point(0.42, 0.45)});
    const auto add_bone = [&](const char* id, const Point& from, const Point& to) {
        rig.handles.push_back({id, BoneHandle{size_px * from, size_px * to, ""}});
    };
    add_bone("spine", places::chest + Point(0, 0.05), places::belly);
    add_bone("left arm", {0.35, 0.35}, {0.2, 0.31});
    add_bone("right arm", {0.65, 0.4}, {0.8, 0.435});
    return rig;
}

void factor(benchmark::State& state) {
    const TriangleMesh& mesh = figure_of(static_cast<int>(state.range(0)));
    SparseMatrix L = cotangent_stiffness(mesh);
    for (Eigen::Index v = 0; v < L.rows(); ++v) L.coeffRef(v, v) += 1e-6;
    const SparseMatrix lower = L.triangularView<Eigen::Lower>();
    for (auto unused : state) {
        (void)unused;
        benchmark::DoNotOptimize(CholeskyPattern(lower).factorise(lower));
    }
    state.counters["vertices"] = static_cast<double>(mesh.V.rows());
}

constexpr int cage_corners = 20;

Rig one_cage(const TriangleMesh& mesh) {
    Rig rig;
    add_automatic_cage(rig, mesh, cage_corners);
    return rig;
}

void automatic_cage(benchmark::State& state) {
    const TriangleMesh& mesh = figure_of(static_cast<int>(state.range(0)));
    for (auto unused : state) {
        (void)unused;
        benchmark::DoNotOptimize(one_cage(mesh));
    }
    state.counters["vertices"] = static_cast<double>(mesh.V.rows());
}

void weigh(benchmark::State& state, const TriangleMesh& mesh, const Rig& rig, WeightKind kind, Partition partition) {
    WeightOptions options;
    options.kind = kind;
    options.partition = partition;
    Progress progress;
    Weights found;
    for (auto unused : state) {
        (void)unused;
        found = compute_weights(mesh, rig, options, progress);
    }
    state.counters["vertices"] = static_cast<double>(mesh.V.rows());
    state.counters["iterations"] = found.iterations;
    state.counters["kkt"] = found.kkt_residual;
    state.counters["sum"] = found.partition_error;
    state.SetLabel(found.converged ? found.fallback : "not converged");
}

void weights(benchmark::State& state, WeightKind kind, Partition partition) {
    weigh(state, figure_of(static_cast<int>(state.range(0))), ten_handles(), kind, partition);
}

void cage(benchmark::State& state, WeightKind kind, Partition partition) {
    const TriangleMesh& mesh = figure_of(static_cast<int>(state.range(0)));
    weigh(state, mesh, one_cage(mesh), kind, partition);
}

void sizes(benchmark::internal::Benchmark* bench) {
    bench->Arg(5000)->Arg(20000)->Unit(benchmark::kMillisecond);
}

BENCHMARK(factor)->Apply(sizes)->Name("factor_of_L");
BENCHMARK_CAPTURE(weights, bbw_normalised, WeightKind::bbw, Partition::normalised)->Apply(sizes);
BENCHMARK_CAPTURE(weights, bbw_coupled, WeightKind::bbw, Partition::coupled)->Apply(sizes);
BENCHMARK_CAPTURE(weights, harmonic, WeightKind::harmonic, Partition::coupled)->Apply(sizes);
BENCHMARK_CAPTURE(weights, biharmonic, WeightKind::biharmonic, Partition::coupled)->Apply(sizes);
BENCHMARK_CAPTURE(weights, monotonic, WeightKind::monotonic, Partition::coupled)->Apply(sizes);
BENCHMARK_CAPTURE(weights, l1, WeightKind::l1, Partition::coupled)->Apply(sizes);
BENCHMARK_CAPTURE(weights, shepard, WeightKind::shepard, Partition::coupled)->Apply(sizes);
BENCHMARK(automatic_cage)->Apply(sizes);
BENCHMARK_CAPTURE(cage, mean_value, WeightKind::mean_value, Partition::coupled)->Apply(sizes);
BENCHMARK_CAPTURE(cage, cauchy, WeightKind::cauchy, Partition::coupled)->Apply(sizes);
BENCHMARK_CAPTURE(cage, harmonic_cage, WeightKind::harmonic_cage, Partition::coupled)->Apply(sizes);
BENCHMARK_CAPTURE(cage, bbw_normalised, WeightKind::bbw, Partition::normalised)->Apply(sizes);
BENCHMARK_CAPTURE(cage, bbw_coupled, WeightKind::bbw, Partition::coupled)->Apply(sizes);

}  // namespace
}  // namespace puppetwarp
