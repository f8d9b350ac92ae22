// Comparing two pictures, beside reading them once (memcmp).

#include <puppetwarp/diff/compare.h>

#include <benchmark/benchmark.h>
#include <opencv2/core.hpp>

#include <cstring>

namespace {

puppetwarp::Image twelve_megapixels(int depth) {
    puppetwarp::Image image;
    image.pixels = cv::Mat(3000, 4000, CV_MAKETYPE(depth, 4));
    cv::RNG random(1);
    random.fill(image.pixels, cv::RNG::UNIFORM, 0, depth == CV_32F ? 1 : 256);
    return image;
}

struct Pair {
    puppetwarp::Image expected, actual;

    // Every sample differs by 1 or 0 when `everywhere`, else one pixel.
    Pair(int depth, bool everywhere) : expected(twelve_megapixels(depth)) {
        actual.pixels = expected.pixels.clone();
        if (everywhere) {
            actual.pixels += cv::Scalar::all(depth == CV_32F ? 0.01 : 1);
        } else {
            actual.pixels(cv::Rect(1234, 1234, 1, 1)).setTo(cv::Scalar::all(0));
        }
    }
};

void BM_memcmp(benchmark::State& state) {
    const Pair pair(static_cast<int>(state.range(0)), false);
    const cv::Mat copy = pair.expected.pixels.clone();
    for (auto _ : state) {
        benchmark::DoNotOptimize(std::memcmp(pair.expected.pixels.data, copy.data, copy.total() * copy.elemSize()));
    }
}

void BM_compare(benchmark::State& state) {
    const Pair pair(static_cast<int>(state.range(0)), state.range(1) != 0);
    for (auto _ : state) benchmark::DoNotOptimize(puppetwarp::compare(pair.expected, pair.actual));
}

void BM_heat_map(benchmark::State& state) {
    const Pair pair(static_cast<int>(state.range(0)), state.range(1) != 0);
    for (auto _ : state) benchmark::DoNotOptimize(puppetwarp::heat_map(pair.expected, pair.actual));
}

const std::vector<std::int64_t> kDepths{CV_8U, CV_16U, CV_32F};

BENCHMARK(BM_memcmp)->ArgName("depth")->ArgsProduct({kDepths})->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK(BM_compare)
    ->ArgNames({"depth", "everywhere"})
    ->ArgsProduct({kDepths, {0, 1}})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK(BM_heat_map)
    ->ArgNames({"depth", "everywhere"})
    ->ArgsProduct({{CV_8U}, {0, 1}})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

}  // namespace
