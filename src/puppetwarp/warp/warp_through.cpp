#include <puppetwarp/warp/displacement.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/base/threads.h>
#include <puppetwarp/warp/map_places.h>
#include <puppetwarp/warp/point_sampler.h>
#include <puppetwarp/warp/spans.h>
#include <puppetwarp/warp/warp_input.h>

#include <opencv2/core.hpp>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <type_traits>

namespace puppetwarp {

namespace {

using detail::MapPlaces;

constexpr int band_rows = 32;
constexpr int bands_between_reports = 16;
// Slopes are differences of numbers that were rounded.
constexpr double least_slope_noise = 1e-4;

// Paints what a map shows of a picture, pixel by pixel.
class MapPainter {
public:
    MapPainter(const MapPlaces& places, const detail::PointSampler& sampler, double rounding_px, cv::Mat& out)
        : places_(places),
          sampler_(sampler),
          format_(sampler.format()),
          slope_noise_(least_slope_noise + 4 * rounding_px),
          out_(out) {}

    void paint(detail::RowRange rows) const {
        for (int row = rows.first; row < rows.last; ++row) {
            unsigned char* pixel = out_.ptr(row);
            for (int column = 0; column < out_.cols; ++column, pixel += format_.out_bytes()) {
                if (const auto shown = places_.shown(column, row)) {
                    sampler_.sample(shown->at, shown->slope, slope_noise_, pixel);
                    if (shown->shown < 1) fade(pixel, shown->shown);
                } else {
                    std::memset(pixel, 0, format_.out_bytes());
                }
            }
        }
    }

private:
    void fade(unsigned char* pixel, double shown) const {
        switch (format_.depth) {
            case CV_8U: fade_alpha(reinterpret_cast<std::uint8_t*>(pixel), shown); break;
            case CV_16U: fade_alpha(reinterpret_cast<std::uint16_t*>(pixel), shown); break;
            default: fade_alpha(reinterpret_cast<float*>(pixel), shown); break;
        }
    }

    template <class T>
    void fade_alpha(T* pixel, double shown) const {
        const int channels = format_.out_channels();
        const double faded = static_cast<double>(pixel[channels - 1]) * shown;
        pixel[channels - 1] = static_cast<T>(std::is_floating_point_v<T> ? faded : faded + 0.5);
        if (pixel[channels - 1] == 0) std::fill_n(pixel, channels, T{});
    }

    const MapPlaces& places_;
    const detail::PointSampler& sampler_;
    detail::PixelFormat format_;
    double slope_noise_;
    cv::Mat& out_;
};

bool covers(const MapPlaces& places, const Canvas& canvas) {
    std::atomic<bool> all = true;
    parallel_for(0, canvas.height, band_rows, [&](int first, int last) {
        for (int row = first; row < last && all.load(std::memory_order_relaxed); ++row) {
            for (int column = 0; column < canvas.width; ++column) {
                if (!places.is_covered(column, row)) all = false;
            }
        }
    });
    return all;
}

void require_map(const DisplacementMap& map, const ThroughMapOptions& options) {
    const DisplacementPlane& plane = map.plane;
    if (map.displacement.empty() || map.displacement.type() != CV_32FC3 ||
        map.displacement.cols != plane.canvas.width || map.displacement.rows != plane.canvas.height ||
        plane.source_width < 1 || plane.source_height < 1 || !(plane.scale > 0))
        throw InvalidInput("displacement map", "its sizes do not fit together");
    const Eigen::Array2d magnification(options.x_magnification, options.y_magnification);
    if (!(magnification > 0).all() || !magnification.allFinite())
        throw InvalidInput("magnification", "is not a finite number above 0");
}

Canvas chosen_canvas(const DisplacementMap& map, const ThroughMapOptions& options) {
    const bool all = options.canvas.width == 0 && options.canvas.height == 0;
    if (all) return scaled_canvas(map.plane.canvas, options.x_magnification, options.y_magnification);
    detail::require_possible(options.canvas.width, options.canvas.height);
    return options.canvas;
}

}  // namespace

Image warp_through(const Image& image, const DisplacementMap& map, const ThroughMapOptions& options,
                   Progress& progress) {
    require_map(map, options);
    const Canvas canvas = chosen_canvas(map, options);
    progress.step("warp", 0);
    const MapPlaces places(map, canvas, {options.x_magnification, options.y_magnification}, image);
    const detail::PointSampler sampler(image, !image.has_alpha() && !covers(places, canvas), options.interpolation,
                                       options.linear);
    const detail::PixelFormat& format = sampler.format();
    Image result{detail::allocate_canvas(canvas, CV_MAKETYPE(format.depth, format.out_channels())), image.metadata};
    const MapPainter painter(places, sampler, map.rounding_px, result.pixels);
    constexpr int rows_between_reports = band_rows * bands_between_reports;
    for (int row = 0; row < canvas.height; row += rows_between_reports) {
        progress.step("warp", static_cast<double>(row) / canvas.height);
        parallel_for(row, std::min(canvas.height, row + rows_between_reports), band_rows, [&](int first, int last) {
            painter.paint({first, last});
        });
    }
    progress.step("warp", 1);
    return result;
}

Image warp_through(const Image& image, const DisplacementMap& map, const ThroughMapOptions& options) {
    Progress progress;
    return warp_through(image, map, options, progress);
}

}  // namespace puppetwarp
