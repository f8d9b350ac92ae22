#include <puppetwarp/warp/warp_input.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/warp/painters_order.h>

#include <opencv2/core.hpp>

#include <cmath>
#include <string>
#include <utility>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace puppetwarp::detail {

namespace {

// Far beyond any picture, and small enough for exact arithmetic with room to spare.
constexpr double farthest_moved_px = 1 << 30;
constexpr double farthest_rest_px = 1 << 28;

void require_warpable(const TriangleMesh& rest, const Eigen::MatrixX2d& moved) {
    if (moved.rows() != rest.V.rows()) {
        throw InvalidInput("moved positions", "there are " + std::to_string(moved.rows()) + " for a mesh of " +
                                                  std::to_string(rest.V.rows()) + " vertices");
    }
    if (!moved.allFinite()) throw InvalidInput("moved positions", "not all are finite numbers");
    if (!rest.V.allFinite()) throw InvalidInput("mesh", "not all positions are finite numbers");
    if (rest.F.size() > 0 && (rest.F.minCoeff() < 0 || rest.F.maxCoeff() >= rest.V.rows())) {
        throw InvalidInput("mesh", "a triangle names a vertex that is not there");
    }
}

// Touching fresh memory page by page costs a third of a warp's time; in huge pages a twentieth.
void ask_for_huge_pages([[maybe_unused]] cv::Mat& pixels) {
#if defined(__linux__)
    constexpr std::uintptr_t page = 4096;
    const auto begin = reinterpret_cast<std::uintptr_t>(pixels.datastart) / page * page;
    const auto end = reinterpret_cast<std::uintptr_t>(pixels.dataend) / page * page;
    if (end > begin) madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE);  // a hint: may fail
#endif
}

}  // namespace

bool is_within_reach(double coordinate) {
    return std::abs(coordinate) <= farthest_moved_px;
}

void require_possible(std::int64_t width, std::int64_t height) {
    if (width <= 0 || height <= 0) {
        throw InvalidInput("canvas", "its size is " + std::to_string(width) + " x " + std::to_string(height),
                           "both sides must be at least 1");
    }
    if (width * height > std::int64_t{2147483647}) {
        throw InvalidInput("canvas", std::to_string(width) + " x " + std::to_string(height) + " pixels are too many",
                           "choose a smaller canvas");
    }
}

WarpInput checked_input(const TriangleMesh& rest, const Eigen::MatrixX2d& moved, const WarpOptions& options, int width,
                        int height) {
    require_warpable(rest, moved);
    const bool none = options.canvas.width == 0 && options.canvas.height == 0;
    const Canvas chosen = none ? Canvas{0, 0, width, height} : options.canvas;
    require_possible(chosen.width, chosen.height);
    if (!is_within_reach(chosen.x) || !is_within_reach(chosen.y)) {
        throw InvalidInput("canvas", "it lies more than 2^30 pixels away", "choose a canvas near the picture");
    }
    TriangleMesh painted{rest.V.cwiseMax(-farthest_rest_px).cwiseMin(farthest_rest_px), rest.F};
    if (options.depth.size() > 0) painted.F = rest.F(painters_order(rest, options.depth), Eigen::all);
    return {std::move(painted), moved.cwiseMax(-farthest_moved_px).cwiseMin(farthest_moved_px), chosen};
}

cv::Mat allocate_canvas(const Canvas& canvas, int type) {
    try {
        cv::Mat pixels(canvas.height, canvas.width, type);
        ask_for_huge_pages(pixels);
        return pixels;
    } catch (const cv::Exception&) {
        throw MachineFault("canvas",
                           "there is not enough memory for " + std::to_string(canvas.width) + " x " +
                               std::to_string(canvas.height) + " pixels",
                           "choose a smaller canvas");
    }
}

}  // namespace puppetwarp::detail
