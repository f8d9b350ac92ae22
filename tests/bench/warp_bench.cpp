// The warp beside cv::remap (with its map ready) and memcpy, all in one process, both on the same number of threads, in
// turns. `ratio`: how many times faster the warp is than the cv::remap of the same filter and picture. Argument
// `fresh`: 1, both get their output picture from the system each time, page by page; 0, freed memory stays with the
// process, so that both get pages that were touched before, as if they reused their output.

#include <puppetwarp/base/threads.h>
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
#include <string>
#include <vector>

namespace {

using namespace puppetwarp;

struct Scene {
    Image image;
    TriangleMesh mesh;
    Eigen::MatrixX2d moved;
    cv::Mat map;  // source positions for cv::remap
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
    // remap's map: the source's coordinates warped as a float picture.
    cv::Mat coordinates(height, width, CV_32FC3);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            coordinates.at<cv::Vec3f>(y, x) = {static_cast<float>(x), static_cast<float>(y), 0};
        }
    }
    WarpOptions options;
    options.interpolation = Interpolation::bilinear;
    const Image map = warp({coordinates, {}}, scene.mesh, scene.moved, options);
    std::vector<cv::Mat> planes;
    cv::split(map.pixels, planes);
    cv::merge(std::vector<cv::Mat>{planes[0], planes[1]}, scene.map);
    return scene;
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

template <class Work>
double best_seconds(int times, const Work& work) {
    double best = 1e9;
    for (int i = 0; i < times; ++i) {
        const auto start = std::chrono::steady_clock::now();
        work();
        best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
    return best;
}

void keep_freed_memory(bool keep) {
    mallopt(M_MMAP_THRESHOLD, keep ? 1 << 30 : 1 << 17);
    mallopt(M_TRIM_THRESHOLD, keep ? 2000000000 : 1 << 17);
    malloc_trim(0);
}

constexpr int remap_filter[] = {cv::INTER_NEAREST, cv::INTER_LINEAR, cv::INTER_CUBIC};
constexpr const char* filter_names[] = {"nearest", "bilinear", "bicubic"};

void bench_warp(benchmark::State& state) {
    const int megapixels = static_cast<int>(state.range(0)), channels = static_cast<int>(state.range(2));
    const auto filter = static_cast<std::size_t>(state.range(3));
    const Scene& scene = scene_of(megapixels, static_cast<int>(state.range(1)), channels);
    const int times = megapixels > 20 ? 3 : 7;
    const int threads = static_cast<int>(state.range(4));
    set_thread_count(threads);
    cv::setNumThreads(threads);  // what both of them use
    keep_freed_memory(state.range(5) == 0);
    cv::Mat copy(scene.image.pixels.size(), scene.image.pixels.type());
    const auto bytes = scene.image.pixels.total() * scene.image.pixels.elemSize();
    const double memcpy_s = best_seconds(times, [&] { std::memcpy(copy.data, scene.image.pixels.data, bytes); });
    copy.release();
    const auto remap = [&] {
        cv::Mat out;
        cv::remap(scene.image.pixels, out, scene.map, cv::noArray(), remap_filter[filter], cv::BORDER_REPLICATE);
    };
    WarpOptions options;
    options.interpolation = static_cast<Interpolation>(filter);
    const auto warped = [&] {
        benchmark::DoNotOptimize(warp(scene.image, scene.mesh, scene.moved, options).pixels.data);
    };
    best_seconds(1, remap);
    double warp_s = 1e9, remap_s = 1e9;
    for (auto _ : state) {
        const double s = best_seconds(1, warped);
        warp_s = std::min(warp_s, s);
        state.SetIterationTime(s);
        remap_s = std::min(remap_s, best_seconds(1, remap));
    }
    const double pixels = static_cast<double>(scene.image.pixels.total());
    state.counters["MP/s"] = pixels / warp_s / 1e6;
    state.counters["remap_MP/s"] = pixels / remap_s / 1e6;
    state.counters["memcpy_MP/s"] = pixels / memcpy_s / 1e6;
    state.counters["ratio"] = remap_s / warp_s;
    state.SetLabel(std::string(channels == 3 ? "RGB " : "RGBA ") + filter_names[filter]);
    set_thread_count(0);
}

void all_scenes(benchmark::internal::Benchmark* bench) {
    bench->ArgNames({"MP", "ktri", "ch", "filter", "threads", "fresh"});
    for (int megapixels : {2, 12, 48}) {
        for (int triangles : {2, 20}) {
            for (int channels : {3, 4}) {
                for (int filter : {1, 2, 0}) {
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
