// The command from start to finished file, beside `vips copy` of the same picture in the same run.

#include <puppetwarp/image/write.h>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <benchmark/benchmark.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <string>

namespace {

namespace fs = std::filesystem;

const std::string command = PUPPETWARP_BINARY_DIR "/puppetwarp";

double seconds_of(const std::string& line) {
    const auto start = std::chrono::steady_clock::now();
    if (std::system((line + " > /dev/null").c_str()) != 0) std::abort();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// 12 MP that compress like a photograph: smooth shapes and fine noise.
std::string photograph() {
    static const std::string path = [] {
        cv::RNG random(1);
        cv::Mat shapes(40, 53, CV_8UC3), pixels, noise(3000, 4000, CV_8UC3);
        random.fill(shapes, cv::RNG::UNIFORM, 30, 220);
        cv::resize(shapes, pixels, noise.size(), 0, 0, cv::INTER_CUBIC);
        random.fill(noise, cv::RNG::NORMAL, 8, 4);
        pixels += noise;
        const std::string file = (fs::temp_directory_path() / "puppetwarp-bench-12mp.png").string();
        puppetwarp::write_image({pixels, {}}, file);
        return file;
    }();
    return path;
}

// Eight pins on a mesh of about 5,000 vertices, three of them moved.
void warp_12_mp(benchmark::State& state) {
    const std::string in = photograph();
    const std::string out = in + ".warped.png";
    const std::string copy = in + ".copy.png";
    const std::string warp = command + " warp " + in + " -q -o " + out +
                             " --pin 500,500 --pin 3500,500:3400,600 --pin 500,2500 --pin 3500,2500 "
                             "--pin 2000,1500:2100,1450 --pin 1000,1500 --pin 3000,1500 --pin 2000,2700:2050,2750";
    const std::string vips = "vips copy " + in + " '" + copy + "[compression=1]'";
    double warping = 1e9, copying = 1e9;
    for (auto _ : state) {
        copying = std::min(copying, seconds_of(vips));
        warping = std::min(warping, seconds_of(warp));
    }
    state.counters["warp_s"] = warping;
    state.counters["vips_copy_s"] = copying;
    state.counters["ratio"] = warping / copying;
    for (const std::string& file : {out, copy}) fs::remove(file);
}
BENCHMARK(warp_12_mp)->Iterations(5)->Unit(benchmark::kMillisecond)->UseRealTime();

void start(benchmark::State& state, const std::string& arguments) {
    double least = 1e9;
    for (auto _ : state) least = std::min(least, seconds_of(command + " " + arguments));
    state.counters["least_s"] = least;
}
BENCHMARK_CAPTURE(start, version, "--version")->Iterations(20)->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(start, info, "info " PUPPETWARP_SOURCE_DIR "/images/gingerbread.png")
    ->Iterations(20)
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

}  // namespace
