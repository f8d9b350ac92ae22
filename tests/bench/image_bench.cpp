// Pictures in files: reading and writing, beside what libvips alone does with the same file ("yardstick").
#include <puppetwarp/image/read.h>
#include <puppetwarp/image/write.h>

#include <benchmark/benchmark.h>
#include <opencv2/core.hpp>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <random>
#include <stdexcept>
#include <string>

namespace {

using namespace puppetwarp;
namespace fs = std::filesystem;

// Something like a photograph: soft shapes and fine noise; alpha like a cut-out's: zero, full, a soft edge.
cv::Mat photo(int width, int height) {
    cv::Mat pixels(height, width, CV_8UC4);
    std::mt19937 random(1);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const double shade =
                120 + 60 * std::sin(x * 0.004) * std::cos(y * 0.003) + 30 * std::sin(x * 0.05 + y * 0.03);
            const int grain = static_cast<int>(random() % 9) - 4;
            const double distance = std::hypot(x - width / 2.0, y - height / 2.0) - 0.45 * height;
            pixels.at<cv::Vec4b>(y, x) = cv::Vec4b(
                cv::saturate_cast<uchar>(shade + grain), cv::saturate_cast<uchar>(shade * 0.8 + grain),
                cv::saturate_cast<uchar>(200 - shade + grain), cv::saturate_cast<uchar>(-distance * 64 + 128));
        }
    }
    return pixels;
}

fs::path folder() {
    const fs::path path = fs::temp_directory_path() / "puppetwarp-bench-image";
    fs::create_directories(path);
    return path;
}

// A picture of so many million pixels; PUPPETWARP_BENCH_PHOTO names another one to take instead.
const Image& picture(int megapixels) {
    static std::map<int, Image> pictures;
    Image& image = pictures[megapixels];
    if (image.pixels.empty()) {
        const char* other = std::getenv("PUPPETWARP_BENCH_PHOTO");
        const int height = static_cast<int>(std::sqrt(megapixels * 1e6 * 3 / 4));
        image = other != nullptr ? read_image(other) : Image{photo(height * 4 / 3, height), {}};
    }
    return image;
}

double seconds(const auto& work) {
    const auto begin = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

void run(const std::string& command) {
    if (std::system(command.c_str()) != 0) throw std::runtime_error(command);
}

void megapixels_a_second(benchmark::State& state, const Image& image) {
    state.counters["MP/s"] = benchmark::Counter(static_cast<double>(image.pixels.total()) / 1e6,
                                                benchmark::Counter::kIsIterationInvariantRate);
}

void read_png(benchmark::State& state) {
    const Image& image = picture(static_cast<int>(state.range(0)));
    const fs::path path = folder() / "read.png";
    write_image(image, path);
    for (auto _ : state) benchmark::DoNotOptimize(read_image(path));
    megapixels_a_second(state, image);
}
BENCHMARK(read_png)->Arg(2)->Arg(12)->Arg(48)->Unit(benchmark::kMillisecond)->UseRealTime();

void write_png(benchmark::State& state) {
    const Image& image = picture(static_cast<int>(state.range(0)));
    const fs::path path = folder() / "write.png";
    const int compression = static_cast<int>(state.range(1));
    for (auto _ : state) write_image(image, path, {.compression = compression});
    megapixels_a_second(state, image);
    state.counters["bytes/pixel"] =
        static_cast<double>(fs::file_size(path)) / static_cast<double>(image.pixels.total());
}
BENCHMARK(write_png)
    ->Args({2, 1})
    ->Args({12, 0})
    ->Args({12, 1})
    ->Args({12, 6})
    ->Args({48, 1})
    ->Unit(benchmark::kMillisecond)
    ->UseRealTime();

void write_other(benchmark::State& state, const std::string& extension) {
    const Image& image = picture(12);
    const fs::path path = folder() / ("write." + extension);
    for (auto _ : state) write_image(image, path);
    megapixels_a_second(state, image);
}
BENCHMARK_CAPTURE(write_other, jpeg, "jpg")->Unit(benchmark::kMillisecond)->UseRealTime();
BENCHMARK_CAPTURE(write_other, tiff, "tif")->Unit(benchmark::kMillisecond)->UseRealTime();

// The same way through `vips copy`, a process with its start; `ours` is reading and writing in this process.
void copy_png_yardstick(benchmark::State& state) {
    const Image& image = picture(12);
    const fs::path in = folder() / "in.png";
    const fs::path out = folder() / "out.png";
    write_image(image, in);
    double yardstick = 0;
    double ours = 0;
    for (auto _ : state) {
        yardstick += seconds([&] { run("vips copy " + in.string() + " '" + out.string() + "[compression=1]'"); });
        ours += seconds([&] { write_image(read_image(in), out); });
    }
    state.counters["ours_ms"] = 1e3 * ours / static_cast<double>(state.iterations());
    state.counters["vips_copy_ms"] = 1e3 * yardstick / static_cast<double>(state.iterations());
    state.counters["ratio"] = ours / yardstick;
}
BENCHMARK(copy_png_yardstick)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace
