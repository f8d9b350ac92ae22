#include "scenes.h"

#include <puppetwarp/base/threads.h>
#include <puppetwarp/warp/warp_job.h>

#include <gtest/gtest.h>
#include <opencv2/core/parallel/parallel_backend.hpp>

#include <atomic>
#include <memory>
#include <thread>
#include <utility>

namespace puppetwarp::testing {
namespace {

using detail::Simd;

// As many threads as are asked for, on whatever cores there are: OpenCV's own are no more than the cores, and thread
// sanitizers do not see into the library that they wait by.
class RealThreads : public cv::parallel::ParallelForAPI {
public:
    explicit RealThreads(int count) : count_(count) {}
    void parallel_for(int tasks, FN_parallel_for_body_cb_t body, void* data) override {
        std::atomic<int> next = 0;
        const auto work = [&] {
            for (int task = next++; task < tasks; task = next++) body(task, task + 1, data);
        };
        std::vector<std::thread> threads;
        for (int k = 0; k < count_; ++k) threads.emplace_back(work);
        for (std::thread& thread : threads) thread.join();
    }
    int getThreadNum() const override { return 0; }
    int getNumThreads() const override { return count_; }
    int setNumThreads(int) override { return count_; }
    const char* getName() const override { return "real threads"; }

private:
    int count_;
};

class SameBytes : public ::testing::TestWithParam<int> {
protected:
    SameBytes() { set_thread_count(2); }  // from two on OpenCV asks who shall do the work
    ~SameBytes() override {
        cv::parallel::setParallelForBackend(std::shared_ptr<cv::parallel::ParallelForAPI>());
        set_thread_count(threads_before_);
    }

    // Against portable code in one thread.
    static void expect_same(const Image& image, const TriangleMesh& rest, const Eigen::MatrixX2d& moved,
                            const WarpOptions& options, const std::vector<std::pair<int, Simd>>& ways) {
        Progress progress;
        use_threads(1);
        const Image expected = detail::warp_with(Simd::scalar, image, rest, moved, options, progress);
        for (const auto& [threads, simd] : ways) {
            if (simd > detail::best_simd()) continue;
            use_threads(threads);
            const Image result = detail::warp_with(simd, image, rest, moved, options, progress);
            EXPECT_TRUE(same_bytes(result.pixels, expected.pixels))
                << threads << " threads, instructions " << static_cast<int>(simd) << ", "
                << interpolation_names()[static_cast<std::size_t>(options.interpolation)]
                << (options.linear ? ", linear" : "");
        }
    }

private:
    static void use_threads(int count) {
        cv::parallel::setParallelForBackend(std::make_shared<RealThreads>(count), false);
    }

    int threads_before_ = thread_count();
};

TEST_P(SameBytes, ForAnyNumberOfThreadsAndAnyInstructions) {
    Random random(16);
    std::vector<std::pair<int, Simd>> all;
    for (const int threads : {1, 2, 7}) {
        for (const Simd simd : {Simd::scalar, Simd::sse41, Simd::avx2}) all.emplace_back(threads, simd);
    }
    for (const Interpolation interpolation : all_interpolations) {
        for (const Alpha alpha : {Alpha::noise, Alpha::opaque, Alpha::patches}) {
            const Image image = random_image(150, 131, GetParam(), random, alpha);
            const TriangleMesh rest = grid_mesh(-2, -2, 152, 133, 9, 7, random);
            expect_same(image, rest, jittered(rest.V, 9, random), {interpolation, {-9, -9, 170, 150}}, all);
        }
    }
}

// From many times larger to many times smaller, both along one axis and along both, and beyond the picture.
TEST_P(SameBytes, WhereThePictureShrinksAndGrowsInLinearLightToo) {
    Random random(17);
    const std::vector<std::pair<int, Simd>> some{
        {1, Simd::sse41}, {1, Simd::avx2}, {2, Simd::avx2}, {7, Simd::scalar}, {7, Simd::avx2}};
    const TriangleMesh rest = grid_mesh(-2, -2, 302, 262, 12, 11, random);
    Eigen::MatrixX2d moved = rest.V;
    for (Eigen::Index i = 0; i < moved.rows(); ++i) {
        const double x = moved(i, 0) / 300, y = moved(i, 1) / 260;
        moved.row(i) << 260 * x * x * x, 200 * (0.02 * y + y * y * y);
    }
    moved = jittered(moved, 0.4, random);
    for (const Interpolation interpolation : all_interpolations) {
        for (const bool linear : {false, true}) {
            const Image image = random_image(300, 260, GetParam(), random, linear ? Alpha::noise : Alpha::patches);
            expect_same(image, rest, moved, {interpolation, {-6, -5, 270, 210}, linear}, some);
        }
    }
}

INSTANTIATE_TEST_SUITE_P(AllFormats, SameBytes, ::testing::ValuesIn(all_types), format_name);

}  // namespace
}  // namespace puppetwarp::testing
