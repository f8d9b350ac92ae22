// Comparing two pictures, beside reading them once (memcmp); the command, beside `vips avg` of one file and then the
// other, and beside `idiff` where it is installed; folders of small pictures, pairs a second.

#include <puppetwarp/diff/compare.h>
#include <puppetwarp/image/write.h>

#include <benchmark/benchmark.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>

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

// The other metrics and rules, of pictures that differ everywhere.
void BM_metric(benchmark::State& state, const puppetwarp::CompareOptions& options) {
    Pair pair(CV_8U, true);
    for (puppetwarp::Image* image : {&pair.expected, &pair.actual}) {  // opaque, seen over one ground
        cv::cvtColor(image->pixels, image->pixels, cv::COLOR_RGBA2RGB);
    }
    for (auto _ : state) benchmark::DoNotOptimize(puppetwarp::compare(pair.expected, pair.actual, options));
}
BENCHMARK_CAPTURE(BM_metric, max, {})->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(BM_metric, ssim, {.metric = puppetwarp::DiffMetric::ssim})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(BM_metric, flip, {.metric = puppetwarp::DiffMetric::flip})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();
BENCHMARK_CAPTURE(BM_metric, aa, {.antialiasing = true})->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(BM_metric, window, {.window_px = 8})->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(BM_metric, shift, {.shift_px = 4})->Unit(benchmark::kMillisecond)->UseRealTime();

namespace fs = std::filesystem;

const std::string command = PUPPETWARP_BINARY_DIR "/puppetwarp diff -q ";

double seconds_of(const std::string& line) {
    const auto start = std::chrono::steady_clock::now();
    // 1 is an answer, too; an unknown command is 127.
    if (const int status = std::system((line + " > /dev/null").c_str()); status != 0 && status != 256) return -1;
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// Smooth shapes and fine noise, as of a photograph; another seed gives other noise.
puppetwarp::Image photograph(int width, int height, int seed) {
    cv::RNG random(1), noises(static_cast<std::uint64_t>(seed));
    cv::Mat shapes(40, 53, CV_8UC3), noise(height, width, CV_8UC3);
    puppetwarp::Image image;
    random.fill(shapes, cv::RNG::UNIFORM, 30, 220);
    cv::resize(shapes, image.pixels, noise.size(), 0, 0, cv::INTER_CUBIC);
    noises.fill(noise, cv::RNG::NORMAL, 8, 4);
    image.pixels += noise;
    return image;
}

struct Folder {
    fs::path path = fs::temp_directory_path() / "puppetwarp-bench-diff";
    Folder() { fs::create_directories(path); }
    ~Folder() { fs::remove_all(path); }
};

void command_12_mp(benchmark::State& state, const std::string& options) {
    const Folder folder;
    const std::string a = (folder.path / "a.png").string(), b = (folder.path / "b.png").string();
    puppetwarp::write_image(photograph(4000, 3000, 2), a);
    puppetwarp::write_image(photograph(4000, 3000, 3), b);
    const std::string idiff = "idiff -q -fail 1 " + a + " " + b;
    double reading = 1e9, diffing = 1e9, other = 1e9;
    for (auto _ : state) {
        reading = std::min(reading, seconds_of("vips avg " + a) + seconds_of("vips avg " + b));
        diffing = std::min(diffing, seconds_of(command + a + " " + b + options));
        other = std::min(other, seconds_of(idiff + " 2> /dev/null"));
    }
    state.counters["diff_s"] = diffing;
    state.counters["vips_both_s"] = reading;
    state.counters["of_vips"] = diffing / reading;
    if (other > 0) state.counters["of_idiff"] = diffing / other;
}
BENCHMARK_CAPTURE(command_12_mp, max, "")->Iterations(5)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(command_12_mp, ssim, " --metric ssim")->Iterations(5)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(command_12_mp, flip, " --metric flip")->Iterations(5)->Unit(benchmark::kMillisecond)->UseRealTime();

void thousand_pairs(benchmark::State& state, const std::string& options) {
    const Folder folder;
    const std::string expected = (folder.path / "expected").string(), actual = (folder.path / "actual").string();
    const puppetwarp::Image picture = photograph(200, 250, 2), other = photograph(200, 250, 3);
    for (const std::string& side : {expected, actual}) fs::create_directories(side);
    for (int i = 0; i < 1000; ++i) {
        const std::string name = "/" + std::to_string(i) + ".png";
        puppetwarp::write_image(picture, expected + name);
        puppetwarp::write_image(i % 10 == 0 ? other : picture, actual + name);
    }
    double least = 1e9;
    for (auto _ : state) least = std::min(least, seconds_of(command + expected + " " + actual + options));
    state.counters["pairs_a_second"] = 1000 / least;
}
BENCHMARK_CAPTURE(thousand_pairs, max, "")->Iterations(3)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(thousand_pairs, ssim, " --min-ssim 0.9")->Iterations(3)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
