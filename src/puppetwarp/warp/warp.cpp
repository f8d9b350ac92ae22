#include <puppetwarp/warp/warp.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/base/threads.h>
#include <puppetwarp/warp/paint.h>
#include <puppetwarp/warp/painters_order.h>

#include <opencv2/core.hpp>

#include <array>
#include <cassert>
#include <cmath>
#include <utility>

#if defined(__linux__)
#include <sys/mman.h>
#endif

namespace puppetwarp {

namespace {

constexpr std::array<std::pair<std::string_view, Interpolation>, 3> interpolations{
    {{"nearest", Interpolation::nearest}, {"bilinear", Interpolation::bilinear}, {"bicubic", Interpolation::bicubic}}};

// Far beyond any picture, and small enough for exact arithmetic with room to spare.
constexpr double farthest_moved_px = 1 << 30;
constexpr double farthest_rest_px = 1 << 28;

constexpr int band_rows = 64;  // higher bands set triangles up less often, lower ones share out better among threads
constexpr int pixels_between_reports = 1 << 21;

[[maybe_unused]] bool is_picture(const cv::Mat& pixels) {
    const int depth = pixels.depth();
    return !pixels.empty() && pixels.channels() <= 4 && (depth == CV_8U || depth == CV_16U || depth == CV_32F);
}

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

bool whole_number_fits(double value) {
    return std::abs(value) <= farthest_moved_px;
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

Canvas canvas_of(const Canvas& asked, const Image& image) {
    const bool none = asked.width == 0 && asked.height == 0;
    const Canvas canvas = none ? Canvas{0, 0, image.width(), image.height()} : asked;
    require_possible(canvas.width, canvas.height);
    if (!whole_number_fits(canvas.x) || !whole_number_fits(canvas.y)) {
        throw InvalidInput("canvas", "it lies more than 2^30 pixels away", "choose a canvas near the picture");
    }
    return canvas;
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

cv::Mat allocated(const Canvas& canvas, int type) {
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

// With its triangles in the order in which they are painted.
TriangleMesh within_reach(const TriangleMesh& rest, const Eigen::VectorXd& depth) {
    TriangleMesh mesh{rest.V.cwiseMax(-farthest_rest_px).cwiseMin(farthest_rest_px), rest.F};
    if (depth.size() > 0) mesh.F = rest.F(painters_order(rest, depth), Eigen::all);
    return mesh;
}

void paint_all(const detail::Painter& painter, const Canvas& canvas, Progress& progress) {
    const int bands = (canvas.height - 1) / band_rows + 1;
    const auto bands_between_reports =
        static_cast<int>(std::max<std::int64_t>(2, pixels_between_reports / (std::int64_t{canvas.width} * band_rows)));
    for (int first = 0; first < bands; first += bands_between_reports) {
        progress.step("warp", static_cast<double>(first) / bands);
        parallel_for(first, std::min(bands, first + bands_between_reports), 1, [&](int begin, int end) {
            const auto row = [&](int band) {
                return static_cast<int>(std::min<std::int64_t>(std::int64_t{band} * band_rows, canvas.height));
            };
            for (int band = begin; band < end; ++band) painter.paint({row(band), row(band + 1)});
        });
    }
    progress.step("warp", 1);
}

}  // namespace

std::vector<std::string> interpolation_names() {
    std::vector<std::string> names;
    names.reserve(interpolations.size());
    for (const auto& [name, interpolation] : interpolations) names.emplace_back(name);
    return names;
}

Interpolation interpolation_from_name(std::string_view name) {
    std::string known;
    for (const auto& [known_name, interpolation] : interpolations) {
        if (known_name == name) return interpolation;
        known += (known.empty() ? "" : ", ") + std::string(known_name);
    }
    throw InvalidInput("interpolation '" + std::string(name) + "'", "unknown", "choose one of " + known);
}

std::string back_faces_name(BackFaces back_faces) {
    return back_faces == BackFaces::hide ? "hide" : "show";
}

BackFaces back_faces_from_name(std::string_view name) {
    if (name == "hide") return BackFaces::hide;
    if (name == "show") return BackFaces::show;
    throw InvalidInput("back faces '" + std::string(name) + "'", "unknown", "choose hide or show");
}

Image detail::warp_with(Simd simd, const Image& image, const TriangleMesh& rest, const Eigen::MatrixX2d& moved,
                        const WarpOptions& options, Progress& progress) {
    assert(is_picture(image.pixels));
    require_warpable(rest, moved);
    WarpOptions chosen = options;
    chosen.canvas = canvas_of(options.canvas, image);
    progress.step("warp", 0);

    const TriangleMesh near_rest = within_reach(rest, options.depth);
    const Eigen::MatrixX2d near_moved = moved.cwiseMax(-farthest_moved_px).cwiseMin(farthest_moved_px);
    const SnappedMesh spans(near_rest, near_moved, chosen.canvas, options.back_faces);
    PixelFormat format{image.pixels.depth(), image.pixels.channels(), false};
    format.adds_alpha = !image.has_alpha() && !spans.covers_canvas();

    Image result{allocated(chosen.canvas, CV_MAKETYPE(format.depth, format.out_channels())), image.metadata};
    const Painter painter(image.pixels, format, near_rest, near_moved, spans, chosen, simd, result.pixels);
    paint_all(painter, chosen.canvas, progress);
    return result;
}

Image warp(const Image& image, const TriangleMesh& rest, const Eigen::MatrixX2d& moved, const WarpOptions& options,
           Progress& progress) {
    return detail::warp_with(detail::best_simd(), image, rest, moved, options, progress);
}

Image warp(const Image& image, const TriangleMesh& rest, const Eigen::MatrixX2d& moved, const WarpOptions& options) {
    Progress progress;
    return warp(image, rest, moved, options, progress);
}

Canvas grown_canvas(int width, int height, const Eigen::MatrixX2d& moved) {
    if (!moved.allFinite()) throw InvalidInput("moved positions", "not all are finite numbers");
    Eigen::Array2d low = Eigen::Array2d::Zero(), high(width, height);
    if (moved.rows() > 0) {
        // The solver's noise adds no row of pixels.
        low = low.min(moved.colwise().minCoeff().transpose().array() + detail::translation_tolerance_px).floor();
        high = high.max(moved.colwise().maxCoeff().transpose().array() - detail::translation_tolerance_px).ceil();
    }
    for (int axis = 0; axis < 2; ++axis) {
        if (!whole_number_fits(low[axis]) || !whole_number_fits(high[axis])) {
            throw InvalidInput("canvas", "the moved positions reach too far",
                               "move the handles less, or give a canvas");
        }
    }
    const Eigen::Array2d size = high - low;
    require_possible(static_cast<std::int64_t>(size.x()), static_cast<std::int64_t>(size.y()));
    return {static_cast<int>(low.x()), static_cast<int>(low.y()), static_cast<int>(size.x()),
            static_cast<int>(size.y())};
}

}  // namespace puppetwarp
