#include <puppetwarp/warp/warp.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/base/threads.h>
#include <puppetwarp/warp/light.h>
#include <puppetwarp/warp/paint.h>
#include <puppetwarp/warp/warp_input.h>

#include <opencv2/core.hpp>

#include <array>
#include <cassert>
#include <cmath>
#include <optional>
#include <utility>

namespace puppetwarp {

namespace {

constexpr std::array<std::pair<std::string_view, Interpolation>, 4> interpolations{
    {{"nearest", Interpolation::nearest},
     {"bilinear", Interpolation::bilinear},
     {"bicubic", Interpolation::bicubic},
     {"lanczos3", Interpolation::lanczos3}}};

constexpr int band_rows = 64;  // higher bands set triangles up less often, lower ones share out better among threads
constexpr int pixels_between_reports = 1 << 21;

[[maybe_unused]] bool is_picture(const cv::Mat& pixels) {
    const int depth = pixels.depth();
    return !pixels.empty() && pixels.channels() <= 4 && (depth == CV_8U || depth == CV_16U || depth == CV_32F);
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

// Takes alpha away when it is full everywhere.
void drop_full_alpha(cv::Mat& pixels) {
    const int colours = pixels.channels() - 1;
    cv::Mat alpha;
    cv::extractChannel(pixels, alpha, colours);
    const double full = pixels.depth() == CV_8U ? 255 : pixels.depth() == CV_16U ? 65535 : 1;
    if (cv::countNonZero(alpha != full) > 0) return;
    alpha.release();
    cv::Mat opaque(pixels.size(), CV_MAKETYPE(pixels.depth(), colours));
    constexpr std::array same{0, 0, 1, 1, 2, 2};
    cv::mixChannels(&pixels, 1, &opaque, 1, same.data(), static_cast<std::size_t>(colours));
    pixels = opaque;
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
    const WarpInput input = checked_input(rest, moved, options, image.width(), image.height());
    WarpOptions chosen = options;
    chosen.canvas = input.canvas;
    progress.step("warp", 0);

    const SnappedMesh spans(input.rest, input.moved, chosen.canvas, options.back_faces);
    PixelFormat format{image.pixels.depth(), image.pixels.channels(), false};
    const std::vector<BorderEdge> edges = border_edges(input.rest.F, spans);
    const bool smooth = options.interpolation != Interpolation::nearest;
    const BorderPixels border = smooth ? BorderPixels(input.rest.F, spans, edges, options.frame) : BorderPixels();
    // How many triangles hold a pixel changes at borders only.
    const int layers = edges.empty() ? spans.layers_on_first_pixel() : -1;
    const bool covered = edges.empty() ? layers > 0 : border.empty() && spans.covers_canvas();
    format.adds_alpha = !image.has_alpha() && !covered;

    Image result{allocate_canvas(chosen.canvas, CV_MAKETYPE(format.depth, format.out_channels())), image.metadata};
    const bool decodes = options.linear && format.depth != CV_32F;
    const std::optional<LightTables> light = decodes ? std::optional<LightTables>(image) : std::nullopt;
    const Painter painter({image.pixels, format, light ? &*light : nullptr}, input.rest, input.moved,
                          {spans, border, layers == 1}, chosen, simd, result.pixels);
    paint_all(painter, chosen.canvas, progress);
    // Folds are borders too, but what lies over or under them may well fill the pixels that they cross.
    if (format.adds_alpha && !border.empty() && spans.covers_canvas()) drop_full_alpha(result.pixels);
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
        if (!detail::is_within_reach(low[axis]) || !detail::is_within_reach(high[axis])) {
            throw InvalidInput("canvas", "the moved positions reach too far",
                               "move the handles less, or give a canvas");
        }
    }
    const Eigen::Array2d size = high - low;
    detail::require_possible(static_cast<std::int64_t>(size.x()), static_cast<std::int64_t>(size.y()));
    return {static_cast<int>(low.x()), static_cast<int>(low.y()), static_cast<int>(size.x()),
            static_cast<int>(size.y())};
}

Eigen::AlignedBox2d scaled_frame(const Canvas& canvas, double scale) {
    const Eigen::Vector2d corner(canvas.x, canvas.y);
    return {corner * scale, (corner + Eigen::Vector2d(canvas.width, canvas.height)) * scale};
}

Canvas scaled_canvas(const Canvas& canvas, double x_scale, double y_scale) {
    // An edge is snapped as the triangles' corners are, so that a mesh up to the canvas' edge covers all of it.
    const auto first_pixel = [](double edge) {
        if (!detail::is_within_reach(edge)) {
            throw InvalidInput("canvas", "it reaches more than 2^30 pixels away at this scale",
                               "choose a smaller scale or canvas");
        }
        return detail::first_centre(detail::snapped(edge, 0));
    };
    const std::int64_t left = first_pixel(canvas.x * x_scale), top = first_pixel(canvas.y * y_scale);
    const std::int64_t width = first_pixel((static_cast<double>(canvas.x) + canvas.width) * x_scale) - left;
    const std::int64_t height = first_pixel((static_cast<double>(canvas.y) + canvas.height) * y_scale) - top;
    detail::require_possible(width, height);
    return {static_cast<int>(left), static_cast<int>(top), static_cast<int>(width), static_cast<int>(height)};
}

}  // namespace puppetwarp
