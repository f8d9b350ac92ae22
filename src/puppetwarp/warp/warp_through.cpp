#include <puppetwarp/warp/displacement.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/base/threads.h>
#include <puppetwarp/warp/face_map.h>
#include <puppetwarp/warp/map_places.h>
#include <puppetwarp/warp/pixel_ops.h>
#include <puppetwarp/warp/sampling.h>
#include <puppetwarp/warp/spans.h>
#include <puppetwarp/warp/warp_input.h>

#include <opencv2/core.hpp>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstring>
#include <type_traits>

namespace puppetwarp {

namespace {

using detail::MapPlaces;
using detail::ShownPlace;

constexpr int band_rows = 32;
constexpr int bands_between_reports = 16;
constexpr double least_slope_noise = 1e-4;

// \param noise  of the slope, whose numbers were rounded: a whole factor must not need one sample more for it.
int samples_for(const Eigen::Matrix2d& slope, double noise) {
    if (slope.squaredNorm() <= detail::single_sample_limit * detail::single_sample_limit) return 1;
    const double same = std::hypot(slope(0, 0) + slope(1, 1), slope(1, 0) - slope(0, 1));
    const double opposite = std::hypot(slope(0, 0) - slope(1, 1), slope(1, 0) + slope(0, 1));
    const double largest_stretch = (same + opposite) / 2;
    if (!(largest_stretch > detail::single_sample_limit + noise)) return 1;
    return static_cast<int>(std::ceil(std::min<double>(largest_stretch - noise, detail::most_samples)));
}

std::int64_t fixed_point(double value) {
    return static_cast<std::int64_t>(std::llround(value * detail::fixed_one));
}

// Paints what a map shows of a picture, pixel by pixel.
class MapPainter {
public:
    MapPainter(const cv::Mat& pixels, const MapPlaces& places, const detail::PixelFormat& format,
               Interpolation interpolation, double rounding_px, cv::Mat& out)
        : source_{pixels.data, pixels.step[0], pixels.cols, pixels.rows},
          places_(places),
          format_(format),
          interpolation_(interpolation),
          slope_noise_(least_slope_noise + 4 * rounding_px),
          sample_(detail::find_scalar_sampler(format, interpolation)),
          ops_(detail::find_pixel_ops(format)),
          out_(out) {}

    void paint(detail::RowRange rows) const {
        for (int row = rows.first; row < rows.last; ++row) {
            unsigned char* pixel = out_.ptr(row);
            for (int column = 0; column < out_.cols; ++column, pixel += format_.out_bytes()) {
                if (const auto shown = places_.shown(column, row)) {
                    paint_pixel(*shown, pixel);
                    if (shown->shown < 1) fade(pixel, shown->shown);
                } else {
                    std::memset(pixel, 0, format_.out_bytes());
                }
            }
        }
    }

private:
    void paint_pixel(const ShownPlace& shown, void* pixel) const {
        const int samples = interpolation_ == Interpolation::nearest ? 1 : samples_for(shown.slope, slope_noise_);
        const Point corner = shown.at - Point(0.5, 0.5);
        if (samples > 1) {
            supersample(shown, samples, pixel);
        } else if (corner == corner.array().round().matrix()) {
            ops_.copy(source_, std::lround(corner.x()), std::lround(corner.y()), 1, pixel);
        } else {
            sample_(source_, {fixed_point(corner.x()), fixed_point(corner.y()), 0, 0, 1}, pixel);
        }
    }

    // The pixel's square on a grid, as `warp` has it for the pixels of a triangle.
    void supersample(const ShownPlace& shown, int samples, void* pixel) const {
        alignas(16) std::array<unsigned char, detail::most_samples * 4 * sizeof(float)> row;
        std::array<double, 4> sums{};
        const double step = 1.0 / samples;
        for (int k = 0; k < samples; ++k) {
            const Point offset((step - 1) / 2, (k + 0.5) * step - 0.5);
            const Point corner = shown.at + shown.slope * offset - Point(0.5, 0.5);
            const Point along = shown.slope.col(0) * step;
            sample_(source_,
                    {fixed_point(corner.x()), fixed_point(corner.y()), fixed_point(along.x()), fixed_point(along.y()),
                     samples},
                    row.data());
            ops_.add_samples(row.data(), 1, samples, sums.data());
        }
        ops_.store_means(sums.data(), 1, samples * samples, pixel);
    }

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

    detail::SourceView source_;
    const MapPlaces& places_;
    detail::PixelFormat format_;
    Interpolation interpolation_;
    double slope_noise_;
    detail::RunSampler sample_;
    detail::PixelOps ops_;
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
    detail::PixelFormat format{image.pixels.depth(), image.pixels.channels(), false};
    format.adds_alpha = !image.has_alpha() && !covers(places, canvas);

    const int type = CV_MAKETYPE(format.depth, format.out_channels());
    Image result{detail::allocate_canvas(canvas, type), image.metadata};
    const MapPainter painter(image.pixels, places, format, options.interpolation, map.rounding_px, result.pixels);
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
