// Deformation: what each stage costs, beside a plain local/global iteration and one triangular solve of the same run.
#include "reference/local_global.h"
#include "reference/test_meshes.h"

#include <puppetwarp/deform/deformer.h>
#include <puppetwarp/mesh/operators.h>
#include <puppetwarp/rig/binding.h>
#include <puppetwarp/solve/cholesky.h>

#include <benchmark/benchmark.h>

namespace puppetwarp {
namespace {

namespace places = reference::figure_places;
constexpr double size_px = 1000;

// About 5k and 20k vertices.
TriangleMesh mesh_for(const benchmark::State& state) {
    return reference::figure(size_px, state.range(0) == 5 ? 8.6 : 4.3);
}

Rig eight_pins() {
    return reference::rig_of_points({size_px * places::head, size_px * places::left_hand, size_px * places::right_hand,
                                     size_px * places::left_foot, size_px * places::right_foot, size_px * places::chest,
                                     size_px * places::belly, size_px * places::right_shoulder});
}

Pose typical_pose() {
    Pose pose;
    pose.handles["p0"].to = size_px * places::head + Point(60, 30);
    pose.handles["p1"].to = size_px * places::left_hand + Point(30, 150);
    pose.handles["p2"].to = size_px * places::right_hand + Point(55, -80);
    pose.handles["p3"].to = size_px * places::left_foot + Point(-90, -40);
    return pose;
}

MethodOptions options_of(Method method) {
    MethodOptions options;
    options.method = method;
    return options;
}

void count_vertices(benchmark::State& state, const TriangleMesh& mesh) {
    state.counters["vertices"] = static_cast<double>(mesh.V.rows());
}

void factor_laplacian(benchmark::State& state) {
    const TriangleMesh mesh = mesh_for(state);
    SparseMatrix lower = cotangent_stiffness(mesh).triangularView<Eigen::Lower>();
    for (int v = 0; v < mesh.V.rows(); ++v) lower.coeffRef(v, v) += 1e-6;
    const CholeskyPattern pattern(lower);
    for (auto _ : state) benchmark::DoNotOptimize(pattern.factorise(lower));
    count_vertices(state, mesh);
}

void triangular_solve(benchmark::State& state) {
    const TriangleMesh mesh = mesh_for(state);
    SparseMatrix lower = cotangent_stiffness(mesh).triangularView<Eigen::Lower>();
    for (int v = 0; v < mesh.V.rows(); ++v) lower.coeffRef(v, v) += 1e-6;
    const auto factor = CholeskyPattern(lower).factorise(lower);
    Eigen::VectorXcd b = Eigen::VectorXcd::Ones(mesh.V.rows());
    for (auto _ : state) {
        Eigen::VectorXcd x = b;
        factor->solve_in_place(x);
        benchmark::DoNotOptimize(x.data());
    }
    count_vertices(state, mesh);
}

void make(benchmark::State& state, Method method) {
    const TriangleMesh mesh = mesh_for(state);
    const Rig rig = eight_pins();
    for (auto _ : state) benchmark::DoNotOptimize(make_deformer(options_of(method), mesh, rig));
    count_vertices(state, mesh);
}

void from_rest(benchmark::State& state, Method method) {
    const TriangleMesh mesh = mesh_for(state);
    const auto deformer = make_deformer(options_of(method), mesh, eight_pins());
    const Pose pose = typical_pose();
    Progress progress;
    int iterations = 0;
    for (auto _ : state) iterations = deformer->deform(pose, nullptr, progress).iterations;
    state.counters["iterations"] = iterations;
    count_vertices(state, mesh);
}

// One frame of a linear method once it is prepared; `angles` pins have theirs fixed, of the eight.
void linear_frame(benchmark::State& state, Method method, int angles) {
    const TriangleMesh mesh = mesh_for(state);
    const auto deformer = make_deformer(options_of(method), mesh, eight_pins());
    Pose pose = typical_pose();
    for (int k = 0; k < angles; ++k) pose.handles[std::string("p").append(std::to_string(k))].rotate_rad = 0.1 * k;
    Progress progress;
    for (auto _ : state) benchmark::DoNotOptimize(deformer->deform(pose, nullptr, progress));
    count_vertices(state, mesh);
}

// A ninth pin is set, until it can be dragged; with a region where the method has to solve the mixed system.
void pin_added(benchmark::State& state, Method method, bool with_region) {
    const TriangleMesh mesh = mesh_for(state);
    Rig rig = eight_pins();
    if (with_region) {
        rig.handles.push_back({"torso", RegionHandle{{{420, 540}, {580, 540}, {580, 620}, {420, 620}}, Falloff::none}});
    }
    const auto deformer = make_deformer(options_of(method), mesh, rig);
    rig.handles.push_back({"new", PointHandle{size_px * Point(0.45, 0.5), {}}});
    for (auto _ : state) benchmark::DoNotOptimize(deformer->with_rig(rig));
    count_vertices(state, mesh);
}

// How much of that is taking hold, which all methods pay.
void hold_taken(benchmark::State& state) {
    const TriangleMesh mesh = mesh_for(state);
    const Rig rig = eight_pins();
    for (auto _ : state) benchmark::DoNotOptimize(take_hold(mesh, rig, "bench"));
    count_vertices(state, mesh);
}

// A pin is dragged on by 5 px.
void warm_frame(benchmark::State& state) {
    const TriangleMesh mesh = mesh_for(state);
    const auto deformer = make_deformer({}, mesh, eight_pins());
    Pose pose = typical_pose();
    Progress progress;
    const Eigen::MatrixX2d start = deformer->deform(pose, nullptr, progress).V;
    *pose.handles["p2"].to += Point(3, -4);
    int iterations = 0;
    for (auto _ : state) iterations = deformer->deform(pose, &start, progress).iterations;
    state.counters["iterations"] = iterations;
    count_vertices(state, mesh);
}

// The same frame by twenty plain iterations, their factor included; far from converged.
void local_global_frame(benchmark::State& state) {
    const TriangleMesh mesh = mesh_for(state);
    const auto deformer = make_deformer({}, mesh, eight_pins());
    Progress progress;
    Eigen::MatrixX2d start = deformer->deform(typical_pose(), nullptr, progress).V;
    std::vector<int> held;
    for (const Hold& hold : take_hold(mesh, eight_pins(), "arap").holds) {
        held.push_back(reference::nearest_vertex(mesh, Point(hold.at.real(), hold.at.imag())));
    }
    start.row(held[2]) += Eigen::RowVector2d(3, -4);
    for (auto _ : state) {
        benchmark::DoNotOptimize(reference::local_global(mesh, ArapEnergy::elements, held, start, 0, 20));
    }
    count_vertices(state, mesh);
}

BENCHMARK(triangular_solve)->Arg(5)->Arg(20)->Unit(benchmark::kMillisecond);
BENCHMARK(factor_laplacian)->Arg(5)->Arg(20)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(make, harmonic, Method::harmonic)->Arg(5)->Arg(20)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(make, biharmonic, Method::biharmonic)->Arg(5)->Arg(20)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(make, triharmonic, Method::triharmonic)->Arg(5)->Arg(20)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(make, tetraharmonic, Method::tetraharmonic)->Arg(5)->Arg(20)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(make, thin_shell, Method::thin_shell)->Arg(5)->Arg(20)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(linear_frame, harmonic, Method::harmonic, 0)->Arg(5)->Arg(20)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(linear_frame, tetraharmonic, Method::tetraharmonic, 0)
    ->Arg(5)
    ->Arg(20)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(linear_frame, tetraharmonic_angles, Method::tetraharmonic, 8)
    ->Arg(5)
    ->Arg(20)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(linear_frame, thin_shell_angles, Method::thin_shell, 8)
    ->Arg(5)
    ->Arg(20)
    ->Unit(benchmark::kMillisecond);
BENCHMARK(hold_taken)->Arg(5)->Arg(20)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(pin_added, harmonic, Method::harmonic, false)->Arg(5)->Arg(20)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(pin_added, biharmonic, Method::biharmonic, false)->Arg(5)->Arg(20)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(pin_added, triharmonic, Method::triharmonic, false)->Arg(5)->Arg(20)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(pin_added, tetraharmonic, Method::tetraharmonic, false)
    ->Arg(5)
    ->Arg(20)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(pin_added, thin_shell, Method::thin_shell, false)->Arg(5)->Arg(20)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(pin_added, biharmonic_region, Method::biharmonic, true)
    ->Arg(5)
    ->Arg(20)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(make, arap, Method::arap)->Arg(5)->Arg(20)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(from_rest, harmonic, Method::harmonic)->Arg(5)->Arg(20)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(from_rest, biharmonic, Method::biharmonic)->Arg(5)->Arg(20)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(from_rest, arap, Method::arap)->Arg(5)->Arg(20)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(make, laplacian, Method::laplacian)->Arg(5)->Arg(20)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(make, laplacian_rotated, Method::laplacian_rotated)->Arg(5)->Arg(20)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(make, laplacian_similarity, Method::laplacian_similarity)
    ->Arg(5)
    ->Arg(20)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(make, multiresolution, Method::multiresolution)->Arg(5)->Arg(20)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(make, mls_affine, Method::mls_affine)->Arg(5)->Arg(20)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(make, mls_rigid, Method::mls_rigid)->Arg(5)->Arg(20)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(from_rest, laplacian, Method::laplacian)->Arg(5)->Arg(20)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(from_rest, laplacian_rotated, Method::laplacian_rotated)
    ->Arg(5)
    ->Arg(20)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(from_rest, laplacian_similarity, Method::laplacian_similarity)
    ->Arg(5)
    ->Arg(20)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(from_rest, multiresolution, Method::multiresolution)->Arg(5)->Arg(20)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(from_rest, mls_affine, Method::mls_affine)->Arg(5)->Arg(20)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(from_rest, mls_rigid, Method::mls_rigid)->Arg(5)->Arg(20)->Unit(benchmark::kMillisecond);
BENCHMARK(warm_frame)->Arg(5)->Arg(20)->Unit(benchmark::kMillisecond);
BENCHMARK(local_global_frame)->Arg(5)->Arg(20)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace puppetwarp
