// Drags: what a frame costs until no vertex is farther than half a thousandth of the diagonal from the converged
// answer.
#include "reference/test_meshes.h"

#include <puppetwarp/deform/interactive_solver.h>
#include <puppetwarp/deform/local_global.h>
#include <puppetwarp/mesh/distortion.h>

#include <benchmark/benchmark.h>

#include <chrono>
#include <cmath>
#include <complex>
#include <ctime>

namespace puppetwarp {
namespace {

namespace places = reference::figure_places;
constexpr double size_px = 1000;
constexpr int frames = 24;

// About 5k and 20k vertices.
TriangleMesh mesh_for(std::int64_t thousands) {
    return reference::figure(size_px, thousands == 5 ? 8.6 : 4.3);
}

std::vector<Point> pin_places() {
    return {size_px * places::head,      size_px * places::left_hand,     size_px * places::right_hand,
            size_px * places::left_foot, size_px * places::right_foot,    size_px * places::chest,
            size_px * places::belly,     size_px * places::right_shoulder};
}

// Swung about a joint by up to 50 degrees to either side, `way` along the arc.
Point swung(const Point& hand, const Point& joint, double way) {
    constexpr double widest = 0.9;
    const Point arm = hand - joint;
    const double angle = widest * std::sin(way / arm.norm() / widest);
    return joint + Point(std::cos(angle) * arm.x() - std::sin(angle) * arm.y(),
                         std::sin(angle) * arm.x() + std::cos(angle) * arm.y());
}

// Both hands swing. \param way  of each hand since the beginning, px.
Pose swinging(double way) {
    const std::vector<Point> pins = pin_places();
    Pose pose;
    pose.handles["p1"].to = swung(pins[1], size_px * Point(0.44, 0.4), way);
    pose.handles["p2"].to = swung(pins[2], size_px * Point(0.58, 0.4), -way);
    return pose;
}

// One hand is pushed round in circles, into its arm and out of it.
Pose pushed(double way) {
    const double radius = 0.08 * size_px;
    Pose pose;
    pose.handles["p2"].to = pin_places()[2] + radius * Point(std::cos(way / radius) - 1, std::sin(way / radius));
    return pose;
}

double thread_ms() {
    timespec now{};
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

double local_global_ms(const TriangleMesh& mesh, const Rig& rig) {
    const ArapLocalGlobal alternation(mesh, rig, ArapEnergy::elements);
    Eigen::MatrixX2d V = mesh.V;
    constexpr int steps = 10;
    const double before = thread_ms();
    for (int i = 0; i < steps; ++i) alternation.step(swinging(20), V);
    return (thread_ms() - before) / steps;
}

// args: thousands of vertices; move of the pins a frame, in thousandths of the subject's diagonal (u).
// Time is this thread's: all of it without a worker; with one, what the drag itself waits for.
void drag(benchmark::State& state, Method method, Pose (*pose_at)(double), bool worker) {
    const TriangleMesh mesh = mesh_for(state.range(0));
    const Rig rig = reference::rig_of_points(pin_places());
    const double u = bounding_diagonal(mesh.V) / 1000;
    const double move = static_cast<double>(state.range(1)) * u;
    MethodOptions options;
    options.method = method;
    InteractiveSolver truth(options, mesh, rig, false);
    std::vector<Eigen::MatrixX2d> converged;
    int flipped = 0;
    for (int frame = 1; frame <= frames; ++frame) {
        const Pose pose = pose_at(frame * move);
        InteractiveFrame at = truth.advance(pose, 1e6);
        for (int i = 0; i < 4 && !at.converged; ++i) at = truth.advance(pose, 1e6);
        flipped = std::max(flipped, measure_distortion(mesh, at.V).flipped_triangles);
        converged.push_back(std::move(at.V));
    }
    double total = 0, worst = 0;
    int iterations = 0, missed = 0;
    for (auto _ : state) {
        InteractiveSolver solver(options, mesh, rig, worker);
        total = worst = 0;
        iterations = missed = 0;
        for (int frame = 1; frame <= frames; ++frame) {
            const Pose pose = pose_at(frame * move);
            double took = 0;
            for (int i = 0;; ++i) {
                const double before = thread_ms();
                const InteractiveFrame at = solver.advance(pose, 0);
                took += thread_ms() - before;
                iterations += at.iterations;
                const double off = (at.V - converged[static_cast<std::size_t>(frame - 1)]).rowwise().norm().maxCoeff();
                if (off <= 0.5 * u) break;
                if (i == 100 || at.converged) {
                    ++missed;
                    break;
                }
            }
            total += took;
            worst = std::max(worst, took);
        }
        state.SetIterationTime(total / 1e3);
    }
    state.counters["ms_a_frame"] = total / frames;
    state.counters["worst_ms"] = worst;
    state.counters["iterations"] = static_cast<double>(iterations) / frames;
    state.counters["missed_frames"] = missed;
    state.counters["flipped"] = flipped;
    state.counters["vertices"] = static_cast<double>(mesh.V.rows());
    state.counters["local_global_step_ms"] = local_global_ms(mesh, rig);
}

// A ninth pin set while the hands are up, until the next frame can begin.
void add_a_pin(benchmark::State& state, Method method) {
    const TriangleMesh mesh = mesh_for(state.range(0));
    const Rig rig = reference::rig_of_points(pin_places());
    std::vector<Point> more = pin_places();
    more.push_back(size_px * Point(0.4, 0.8));
    const Rig with_it = reference::rig_of_points(more);
    MethodOptions options;
    options.method = method;
    InteractiveSolver solver(options, mesh, rig);
    solver.advance(swinging(60), 1e6);
    for (auto _ : state) {
        solver.set_rig(with_it);
        state.PauseTiming();
        solver.set_rig(rig);
        state.ResumeTiming();
    }
    state.counters["vertices"] = static_cast<double>(mesh.V.rows());
}

void sizes_and_moves(benchmark::internal::Benchmark* bench) {
    for (const int thousands : {5, 20}) {
        for (const int move : {7, 17}) bench->Args({thousands, move});
    }
    bench->UseManualTime()->Iterations(1)->Unit(benchmark::kMillisecond);
}

BENCHMARK_CAPTURE(drag, arap_swing, Method::arap, swinging, false)->Apply(sizes_and_moves);
BENCHMARK_CAPTURE(drag, smooth_arap_swing, Method::smooth_arap, swinging, false)->Apply(sizes_and_moves);
BENCHMARK_CAPTURE(drag, fold_free_swing, Method::fold_free, swinging, false)->Apply(sizes_and_moves);
BENCHMARK_CAPTURE(drag, arap_push, Method::arap, pushed, false)->Apply(sizes_and_moves);
BENCHMARK_CAPTURE(drag, smooth_arap_push, Method::smooth_arap, pushed, false)->Apply(sizes_and_moves);
BENCHMARK_CAPTURE(drag, fold_free_push, Method::fold_free, pushed, false)->Apply(sizes_and_moves);
BENCHMARK_CAPTURE(drag, arap_swing_with_worker, Method::arap, swinging, true)->Apply(sizes_and_moves);
BENCHMARK_CAPTURE(drag, fold_free_swing_with_worker, Method::fold_free, swinging, true)->Apply(sizes_and_moves);
BENCHMARK_CAPTURE(add_a_pin, arap, Method::arap)->Arg(5)->Arg(20)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(add_a_pin, smooth_arap, Method::smooth_arap)->Arg(5)->Arg(20)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(add_a_pin, fold_free, Method::fold_free)->Arg(5)->Arg(20)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace puppetwarp
