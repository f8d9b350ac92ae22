// The warp beside making a float map and calling cv::remap with it, cv::remap alone with the map ready, and memcpy, all
// in one process, on the same number of threads, in turns. `ratio`: how many times faster the warp is than making the
// map and calling cv::remap with the same filter (Lanczos: 8 x 8 instead of 6 x 6); `ratio_ready`: than cv::remap
// alone. One thread is measured in CPU time, more in time on the clock. Argument `fresh`: 1, all get their output
// picture from the system each time, page by page; 0, freed memory stays with the process, so that they get pages that
// were touched before, as if they reused their output.

#include <puppetwarp/base/threads.h>
#include <puppetwarp/warp/face_map.h>
#include <puppetwarp/warp/spans.h>
#include <puppetwarp/warp/warp.h>

#include <benchmark/benchmark.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <malloc.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <ctime>
#include <string>
#include <vector>

namespace {

using namespace puppetwarp;

struct Scene {
    Image image;
    TriangleMesh mesh;
    Eigen::MatrixX2d moved;
};

cv::Mat textured(int width, int height, int channels) {
    cv::Mat pixels(height, width, CV_8UC(channels));
    std::uint32_t state = 1;
    for (int y = 0; y < height; ++y) {
        auto* p = pixels.ptr<std::uint8_t>(y);
        for (int x = 0; x < width; ++x) {
            state = state * 1664525u + 1013904223u;
            for (int c = 0; c < channels; ++c) {
                const double wave = 100 + 60 * std::sin(0.01 * x * (c + 1)) + 60 * std::cos(0.013 * y);
                *p++ = c == 3 ? 255 : static_cast<std::uint8_t>(wave + (state >> 28));
            }
        }
    }
    return pixels;
}

Eigen::Vector2d displaced(double x, double y, int width, int height) {
    const double u = x / width - 0.5, v = y / height - 0.5;
    // Outwards at the border, so that the whole canvas is covered.
    const double fade = std::cos(M_PI * u) * std::cos(M_PI * v);
    return {x + fade * width * (0.03 * std::sin(6 * v + 1) + 0.02 * std::sin(9 * u)) + 4 * u,
            y + fade * height * (0.03 * std::cos(5 * u) + 0.015 * std::sin(8 * v)) + 4 * v};
}

Scene make_scene(int megapixels, int thousand_triangles, int channels) {
    const int height = static_cast<int>(std::lround(std::sqrt(megapixels * 1e6 / 1.5)));
    const int width = height * 3 / 2;
    Scene scene;
    scene.image.pixels = textured(width, height, channels);
    const int n = static_cast<int>(std::lround(std::sqrt(thousand_triangles * 500.0)));
    scene.mesh.V.resize((n + 1) * (n + 1), 2);
    scene.mesh.F.resize(2 * n * n, 3);
    scene.moved.resize(scene.mesh.V.rows(), 2);
    for (int j = 0; j <= n; ++j) {
        for (int i = 0; i <= n; ++i) {
            const int k = j * (n + 1) + i;
            scene.mesh.V.row(k) << static_cast<double>(width) * i / n, static_cast<double>(height) * j / n;
            scene.moved.row(k) = displaced(scene.mesh.V(k, 0), scene.mesh.V(k, 1), width, height);
            if (i == n || j == n) continue;
            scene.mesh.F.row(2 * (j * n + i)) << k, k + 1, k + n + 1;
            scene.mesh.F.row(2 * (j * n + i) + 1) << k + 1, k + n + 2, k + n + 1;
        }
    }
    return scene;
}

// Source positions for cv::remap. The canvas is covered.
cv::Mat made_map(const Scene& scene) {
    cv::Mat map(scene.image.pixels.size(), CV_32FC2);
    const detail::SnappedMesh spans(scene.mesh, scene.moved, {0, 0, map.cols, map.rows});
    parallel_for(0, map.rows, 64, [&](int begin, int end) {
        const detail::RowRange band{begin, end};
        spans.for_each_triangle_in(band, [&](int triangle) {
            const detail::FaceMap face(scene.mesh, scene.moved, triangle);
            spans.for_each_span_of(triangle, band, [&](int row, int first, int last) {
                const detail::Run run = face.run(first + 0.5, row + 0.5, last - first);
                constexpr float unit = 1 / 4294967296.0F;
                const float u = static_cast<float>(run.u) * unit, v = static_cast<float>(run.v) * unit;
                const float du = static_cast<float>(run.du) * unit, dv = static_cast<float>(run.dv) * unit;
                auto* to = map.ptr<cv::Vec2f>(row) + first;
                for (int i = 0; i < last - first; ++i) {
                    to[i] = {u + static_cast<float>(i) * du, v + static_cast<float>(i) * dv};
                }
            });
        });
    });
    return map;
}

// Scenes are large: one at a time.
const Scene& scene_of(int megapixels, int thousand_triangles, int channels) {
    static std::array<int, 3> key{};
    static Scene scene;
    const std::array<int, 3> asked{megapixels, thousand_triangles, channels};
    if (key != asked) {
        scene = {};
        scene = make_scene(megapixels, thousand_triangles, channels);
        key = asked;
    }
    return scene;
}

double now_s(bool of_cpu) {
    if (!of_cpu) return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
    timespec time{};
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

// The least of several times.
class Stopwatch {
public:
    explicit Stopwatch(bool of_cpu) : of_cpu_(of_cpu) {}

    template <class Work>
    double time(const Work& work) {
        const double start = now_s(of_cpu_);
        work();
        const double took = now_s(of_cpu_) - start;
        least_s = std::min(least_s, took);
        return took;
    }
    double least_s = 1e9;

private:
    bool of_cpu_;
};

void keep_freed_memory(bool keep) {
    mallopt(M_MMAP_THRESHOLD, keep ? 1 << 30 : 1 << 17);
    mallopt(M_TRIM_THRESHOLD, keep ? 2000000000 : 1 << 17);
    malloc_trim(0);
}

constexpr int remap_filter[] = {cv::INTER_NEAREST, cv::INTER_LINEAR, cv::INTER_CUBIC, cv::INTER_LANCZOS4};
constexpr const char* filter_names[] = {"nearest", "bilinear", "bicubic", "lanczos3"};

void bench_warp(benchmark::State& state) {
    const int megapixels = static_cast<int>(state.range(0)), channels = static_cast<int>(state.range(2));
    const auto filter = static_cast<std::size_t>(state.range(3));
    const Scene& scene = scene_of(megapixels, static_cast<int>(state.range(1)), channels);
    const int threads = static_cast<int>(state.range(4));
    set_thread_count(threads);
    cv::setNumThreads(threads);  // what all of them use
    keep_freed_memory(state.range(5) == 0);
    Stopwatch memcpy_time(threads == 1), remap_time(threads == 1), made_time(threads == 1), warp_time(threads == 1);
    cv::Mat copy(scene.image.pixels.size(), scene.image.pixels.type());
    const auto bytes = scene.image.pixels.total() * scene.image.pixels.elemSize();
    for (int i = 0; i < 3; ++i) {
        memcpy_time.time([&] { std::memcpy(copy.data, scene.image.pixels.data, bytes); });
    }
    copy.release();
    const auto remap = [&](const cv::Mat& map) {
        cv::Mat out;
        cv::remap(scene.image.pixels, out, map, cv::noArray(), remap_filter[filter], cv::BORDER_REPLICATE);
    };
    WarpOptions options;
    options.interpolation = static_cast<Interpolation>(filter);
    const cv::Mat ready = made_map(scene);
    remap(ready);
    for (auto _ : state) {
        state.SetIterationTime(warp_time.time(
            [&] { benchmark::DoNotOptimize(warp(scene.image, scene.mesh, scene.moved, options).pixels.data); }));
        made_time.time([&] { remap(made_map(scene)); });
        remap_time.time([&] { remap(ready); });
    }
    const double megapixels_shown = static_cast<double>(scene.image.pixels.total()) / 1e6;
    state.counters["MP/s"] = megapixels_shown / warp_time.least_s;
    state.counters["map_and_remap_MP/s"] = megapixels_shown / made_time.least_s;
    state.counters["remap_MP/s"] = megapixels_shown / remap_time.least_s;
    state.counters["memcpy_MP/s"] = megapixels_shown / memcpy_time.least_s;
    state.counters["ratio"] = made_time.least_s / warp_time.least_s;
    state.counters["ratio_ready"] = remap_time.least_s / warp_time.least_s;
    state.SetLabel(std::string(channels == 3 ? "RGB " : "RGBA ") + filter_names[filter]);
    set_thread_count(0);
}

void all_scenes(benchmark::internal::Benchmark* bench) {
    bench->ArgNames({"MP", "ktri", "ch", "filter", "threads", "fresh"});
    for (int megapixels : {2, 12, 48}) {
        for (int triangles : {2, 20}) {
            for (int channels : {3, 4}) {
                for (int filter : {1, 2, 3, 0}) {
                    for (int threads : {1, 2}) {
                        for (int fresh : {1, 0}) {
                            bench->Args({megapixels, triangles, channels, filter, threads, fresh});
                        }
                    }
                }
            }
        }
    }
}

BENCHMARK(bench_warp)->Apply(all_scenes)->Unit(benchmark::kMillisecond)->UseManualTime()->MinTime(0.2);

}  // namespace
