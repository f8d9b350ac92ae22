// Tracing a matte and triangulating an outline. Yardstick: copying as many bytes as the matte has.

#include <benchmark/benchmark.h>
#include <opencv2/imgproc.hpp>

#include <puppetwarp/mesh/locate.h>
#include <puppetwarp/mesh/outline.h>
#include <puppetwarp/mesh/triangulate.h>

#include <cmath>

namespace {

using namespace puppetwarp;

// A body with a hole and forty spokes, antialiased: about twenty times its width in edge.
cv::Mat silhouette(int megapixels) {
    const int width = static_cast<int>(std::sqrt(megapixels * 1e6 * 4 / 3)), height = width * 3 / 4;
    cv::Mat matte(height, width, CV_8U, cv::Scalar(0));
    const cv::Point middle(width / 2, height / 2);
    cv::ellipse(matte, middle, {width / 3, height / 3}, 20, 0, 360, 255, -1, cv::LINE_AA);
    cv::circle(matte, {width / 4, height / 3}, height / 5, 255, -1, cv::LINE_AA);
    for (int k = 0; k < 40; ++k) {
        const double angle = k * 0.157;
        cv::line(matte, middle,
                 {static_cast<int>(width * (0.5 + 0.45 * std::cos(angle))),
                  static_cast<int>(height * (0.5 + 0.45 * std::sin(angle)))},
                 255, width / 400, cv::LINE_AA);
    }
    cv::circle(matte, middle, height / 9, 0, -1, cv::LINE_AA);
    return matte;
}

// Spread softly to the lower right, at half strength.
cv::Mat with_shadow(const cv::Mat& matte) {
    cv::Mat blurred;
    cv::GaussianBlur(matte, blurred, {61, 61}, 15);
    return cv::max(matte, blurred * 0.5);
}

void copy_matte(benchmark::State& state) {
    const cv::Mat matte = silhouette(static_cast<int>(state.range(0)));
    cv::Mat copy = matte.clone();
    for (auto _ : state) {
        matte.copyTo(copy);
        benchmark::ClobberMemory();
    }
}

void trace(benchmark::State& state) {
    const cv::Mat matte = silhouette(static_cast<int>(state.range(0)));
    for (auto _ : state) benchmark::DoNotOptimize(trace_outline(matte));
}

void trace_shadow(benchmark::State& state) {
    const cv::Mat matte = with_shadow(silhouette(static_cast<int>(state.range(0))));
    for (auto _ : state) benchmark::DoNotOptimize(trace_outline(matte));
}

void triangulate_to(benchmark::State& state) {
    const Outline outline = trace_outline(silhouette(2));
    // The edge length that gives about this many triangles, by bisection on a logarithmic scale.
    double low = 1, high = 400;
    while (high / low > 1.005) {
        const double edge = std::sqrt(low * high);
        (triangulate(outline, {}, {.max_edge_px = edge}).F.rows() > state.range(0) ? low : high) = edge;
    }
    Eigen::Index triangles = 0;
    for (auto _ : state) triangles = triangulate(outline, {}, {.max_edge_px = high}).F.rows();
    state.counters["triangles"] = static_cast<double>(triangles);
}

void locate(benchmark::State& state) {
    const Outline outline = trace_outline(silhouette(2));
    const MeshLocator locator(triangulate(outline));
    double x = 0;
    for (auto _ : state) {
        x = std::fmod(x + 137.1, 1600);
        benchmark::DoNotOptimize(locator.locate({x, 600}));
    }
}

}  // namespace

BENCHMARK(copy_matte)->Arg(2)->Arg(12)->Arg(48)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(trace)->Arg(2)->Arg(12)->Arg(48)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(trace_shadow)->Arg(2)->Arg(12)->Arg(48)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(triangulate_to)->Arg(4000)->Arg(10000)->Arg(40000)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(locate);
