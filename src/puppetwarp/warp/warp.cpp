#include <puppetwarp/warp/warp.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/warp/spans.h>
#include <puppetwarp/warp/warp_input.h>
#include <puppetwarp/warp/warp_job.h>

#include <array>
#include <cmath>
#include <utility>

namespace puppetwarp {

namespace {

constexpr std::array<std::pair<std::string_view, Interpolation>, 4> interpolations{
    {{"nearest", Interpolation::nearest},
     {"bilinear", Interpolation::bilinear},
     {"bicubic", Interpolation::bicubic},
     {"lanczos3", Interpolation::lanczos3}}};

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
