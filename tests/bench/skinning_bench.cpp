// Skinning: one frame by 10 handles, 7 points and 3 bones, on one thread, beside one pass over the weights, which no
// blend can do without: each column's weights times one number, summed by vertex.
#include "reference/test_meshes.h"

#include <puppetwarp/deform/deformer.h>

#include <benchmark/benchmark.h>

#include <string>

namespace puppetwarp {
namespace {

namespace places = reference::figure_places;
constexpr double size_px = 1000;

// About 5k and 20k vertices.
TriangleMesh mesh_for(const benchmark::State& state) {
    return reference::figure(size_px, state.range(0) == 5 ? 8.6 : 4.3);
}

Rig ten_handles() {
    Rig rig = reference::rig_of_points(
        {size_px * places::head, size_px * places::left_hand, size_px * places::right_hand, size_px * places::left_foot,
         size_px * places::right_foot, size_px * Point(0.43, 0.6), size_px * Point(0.57, 0.6)});
    rig.handles.push_back({"spine", BoneHandle{size_px * places::belly, size_px * places::chest, ""}});
    rig.handles.push_back({"neck", BoneHandle{size_px * places::chest, size_px * Point(0.5, 0.28), "spine"}});
    rig.handles.push_back({"arm", BoneHandle{size_px * Point(0.65, 0.4), size_px * Point(0.8, 0.43), "spine"}});
    return rig;
}

// Every handle moves; `angles`: every point turns as it is told, too.
Pose pose_for(const Rig& rig, bool angles) {
    Pose pose;
    double k = 0;
    for (const Handle& handle : rig.handles) {
        HandlePose& target = pose.handles[handle.id];
        ++k;
        if (const auto* point = std::get_if<PointHandle>(&handle.shape)) {
            target.to = point->at + Point(7 * k - 25, 30 - 8 * k);
            if (angles) target.rotate_rad = 0.15 * k - 0.6;
        } else {
            target.rotate_rad = 0.3 - 0.05 * k;
        }
    }
    return pose;
}

MethodOptions options_of(Method method, WeightKind kind) {
    MethodOptions options;
    options.method = method;
    options.weights.kind = kind;
    return options;
}

void pass_over_weights(benchmark::State& state) {
    const TriangleMesh mesh = mesh_for(state);
    const Eigen::MatrixXd W = Eigen::MatrixXd::Constant(mesh.V.rows(), 10, 0.1);
    const Eigen::VectorXd numbers = Eigen::VectorXd::LinSpaced(10, 0, 1);
    Eigen::VectorXd sums(mesh.V.rows());
    for (auto _ : state) {
        sums.noalias() = W * numbers;
        benchmark::DoNotOptimize(sums.data());
    }
    state.counters["vertices"] = static_cast<double>(mesh.V.rows());
}

void frame(benchmark::State& state, Method method, WeightKind kind) {
    const TriangleMesh mesh = mesh_for(state);
    const Rig rig = ten_handles();
    const auto deformer = make_deformer(options_of(method, kind), mesh, rig);
    const Pose pose = pose_for(rig, true);
    Progress progress;
    for (auto _ : state) benchmark::DoNotOptimize(deformer->deform(pose, nullptr, progress));
    state.counters["vertices"] = static_cast<double>(mesh.V.rows());
}

// Points find their angles, each frame from rest.
void frame_with_free_angles(benchmark::State& state, WeightKind kind) {
    const TriangleMesh mesh = mesh_for(state);
    const Rig rig = ten_handles();
    const auto deformer = make_deformer(options_of(Method::fast, kind), mesh, rig);
    Pose pose = pose_for(rig, false);
    Progress progress;
    int iterations = 0;
    for (auto _ : state) {
        const Deformation moved = deformer->deform(pose, nullptr, progress);
        iterations = moved.iterations;
        benchmark::DoNotOptimize(moved.V.data());
    }
    state.counters["vertices"] = static_cast<double>(mesh.V.rows());
    state.counters["iterations"] = iterations;
}

// With scales, which the rigid blends mean by themselves.
void frame_with_scales(benchmark::State& state, Method method) {
    const TriangleMesh mesh = mesh_for(state);
    const Rig rig = ten_handles();
    const auto deformer = make_deformer(options_of(method, WeightKind::harmonic), mesh, rig);
    Pose pose = pose_for(rig, true);
    double scale = 0.9;
    for (auto& [id, target] : pose.handles) target.scale = scale += 0.04;
    Progress progress;
    for (auto _ : state) benchmark::DoNotOptimize(deformer->deform(pose, nullptr, progress));
    state.counters["vertices"] = static_cast<double>(mesh.V.rows());
}

BENCHMARK(pass_over_weights)->Arg(5)->Arg(20)->Unit(benchmark::kMillisecond);
// Harmonic weights are nowhere 0: the most there can be to do.
BENCHMARK_CAPTURE(frame, lbs, Method::lbs, WeightKind::harmonic)->Arg(5)->Arg(20)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(frame, dual_complex, Method::dual_complex, WeightKind::harmonic)
    ->Arg(5)
    ->Arg(20)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(frame, intrinsic, Method::intrinsic, WeightKind::harmonic)
    ->Arg(5)
    ->Arg(20)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(frame, lbs_bbw, Method::lbs, WeightKind::bbw)->Arg(5)->Arg(20)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(frame_with_free_angles, fast, WeightKind::harmonic)->Arg(5)->Arg(20)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(frame_with_free_angles, fast_bbw, WeightKind::bbw)->Arg(5)->Arg(20)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(frame_with_scales, dual_complex, Method::dual_complex)
    ->Arg(5)
    ->Arg(20)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(frame_with_scales, intrinsic, Method::intrinsic)->Arg(5)->Arg(20)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace puppetwarp
