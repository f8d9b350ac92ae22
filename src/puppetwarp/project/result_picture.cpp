#include <puppetwarp/project/result_picture.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/cutout/fill_behind.h>
#include <puppetwarp/image/write.h>

#include <cmath>
#include <string>

namespace puppetwarp {

namespace {

// The picture before the warp, as the result's plane shows it.
Image at_scale(const Image& image, const RenderOptions& options, Progress& progress) {
    if (options.scale == 1) return image;
    TriangleMesh whole{Eigen::MatrixX2d(4, 2), Eigen::MatrixX3i(2, 3)};
    whole.V << 0, 0, image.width(), 0, image.width(), image.height(), 0, image.height();
    whole.F << 0, 1, 2, 0, 2, 3;
    const Canvas own{0, 0, image.width(), image.height()};
    const WarpOptions whole_picture{options.interpolation, scaled_canvas(own, options.scale, options.scale),
                                    options.linear, scaled_frame(own, options.scale)};
    return warp(image, whole, whole.V * options.scale, whole_picture, progress);
}

}  // namespace

void require_scale(double scale) {
    if (!(scale > 0) || !std::isfinite(scale)) throw InvalidInput("scale", "is not a finite number above 0");
}

void require_result_size(const Canvas& canvas, std::int64_t max_pixels) {
    const std::int64_t pixels = std::int64_t{canvas.width} * canvas.height;
    if (pixels > max_pixels) {
        throw InvalidInput("canvas",
                           "would have " + std::to_string(canvas.width) + " x " + std::to_string(canvas.height) +
                               " pixels, more than " + std::to_string(max_pixels),
                           "raise --max-pixels or choose a smaller --canvas or --scale");
    }
}

Image finished_picture(const Image& warped, const Image& original, const Cutout& cutout,
                       const Background& background, const RenderOptions& options, RenderReport& report,
                       Progress& progress) {
    const auto laid_over = [&](const Background& behind, const Image& front) {
        using Kind = Background::Kind;
        if (behind.kind == Kind::inpaint) {
            const Image filled = at_scale(fill_behind(original, cutout, progress), options, progress);
            return lay_over(behind, front, filled, report.canvas, options.linear);
        }
        const bool shows_original = behind.kind == Kind::keep && front.has_alpha();
        return lay_over(behind, front, shows_original ? at_scale(original, options, progress) : original,
                        report.canvas, options.linear);
    };
    Image result = laid_over(background, warped);
    if (options.format.empty()) return result;

    report.lost = lost_in_format(result, options.format);
    if (result.has_alpha() && !format_holds_alpha(options.format)) {
        result = laid_over({cutout.whole ? Background::Kind::keep : Background::Kind::colour, {1, 1, 1, 1}}, result);
    }
    return result;
}

}  // namespace puppetwarp
