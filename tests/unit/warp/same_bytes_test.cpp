#include "scenes.h"

#include <puppetwarp/base/threads.h>
#include <puppetwarp/warp/warp_job.h>

#include <gtest/gtest.h>

#include <utility>

namespace puppetwarp::testing {
namespace {

using detail::Simd;

class SameBytes : public ::testing::TestWithParam<int> {
protected:
    ~SameBytes() override { set_thread_count(threads_before_); }

    // Against portable code in one thread.
    static void expect_same(const Image& image, const TriangleMesh& rest, const Eigen::MatrixX2d& moved,
                            const WarpOptions& options, const std::vector<std::pair<int, Simd>>& ways) {
        Progress progress;
        set_thread_count(1);
        const Image expected = detail::warp_with(Simd::scalar, image, rest, moved, options, progress);
        for (const auto& [threads, simd] : ways) {
            if (simd > detail::best_simd()) continue;
            set_thread_count(threads);
            const Image result = detail::warp_with(simd, image, rest, moved, options, progress);
            EXPECT_TRUE(same_bytes(result.pixels, expected.pixels))
                << threads << " threads, instructions " << static_cast<int>(simd) << ", "
                << interpolation_names()[static_cast<std::size_t>(options.interpolation)]
                << (options.linear ? ", linear" : "");
        }
    }

private:
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
