#include <puppetwarp/project/result_picture.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/cutout/fill_behind.h>
#include <puppetwarp/image/write.h>

#include <opencv2/core.hpp>

#include <chrono>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

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

// A warped picture, on demand or whole, and laid over backgrounds by rows.
class Result {
public:
    Result(const WarpedRows& warped, Image original, const Cutout& cutout, const RenderOptions& options,
           const RenderReport& report, Progress& progress)
        : current_(warped),
          original_(std::move(original)),
          cutout_(cutout),
          options_(options),
          canvas_(report.canvas),
          progress_(progress) {}

    bool has_alpha() const { return CV_MAT_CN(current_.picture.type) % 2 == 0; }
    const PictureRows& picture() const { return current_.picture; }

    void lay_over(const Background& background) {
        // Filling has its say on what it is asked for, also where nothing of it would show.
        if (!has_alpha() && background.kind != Background::Kind::inpaint) return;
        const Image behind = backdrop(background);
        if (!options_.in_rows) whole();  // what is wanted as a whole is not drawn twice to be looked at
        current_ = rows_over(background, current_, behind, canvas_, options_.linear);
        whole_ = {};
    }

    // What the format cannot hold. Whether alpha counts, only the pixels tell, if there are not some without a doubt.
    std::vector<std::string> lost() {
        const PictureRows& rows = current_.picture;
        const bool sure = format_holds_alpha(options_.format) || !has_alpha() || current_.covered == false;
        return lost_in_format(sure ? Image{cv::Mat::zeros(1, 1, rows.type), rows.metadata} : whole(), options_.format);
    }

private:
    // What stands behind the result.
    Image backdrop(const Background& background) {
        // In place: of a large picture there is no second one.
        if (background.kind == Background::Kind::inpaint)
            original_ = fill_behind(std::move(original_), cutout_, progress_);
        const bool shown = background.kind == Background::Kind::inpaint || background.kind == Background::Kind::keep;
        return shown ? at_scale(original_, options_, progress_) : original_;
    }

    const Image& whole() {
        if (whole_.pixels.empty()) {
            whole_ = whole_picture(current_.picture);
            current_.picture = rows_of(whole_);
        }
        return whole_;
    }

    WarpedRows current_;
    Image whole_;  // the same in memory, or nothing
    Image original_;
    const Cutout& cutout_;
    const RenderOptions& options_;
    const Canvas canvas_;
    Progress& progress_;
};

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

PictureRows finished_picture(const WarpedRows& warped, Image original, const Cutout& cutout,
                             const Background& background, const RenderOptions& options, RenderReport& report,
                             Progress& progress) {
    Result result(warped, std::move(original), cutout, options, report, progress);
    result.lay_over(background);
    if (options.format.empty()) return result.picture();

    report.lost = result.lost();
    if (result.has_alpha() && !format_holds_alpha(options.format))
        result.lay_over({cutout.whole ? Background::Kind::keep : Background::Kind::colour, {1, 1, 1, 1}});
    return result.picture();
}

void take_result(const PictureRows& result, const RenderOptions& options, Rendered& rendered) {
    if (options.in_rows) {
        const auto spent_ms = std::make_shared<double>(0);
        rendered.rows = result;
        rendered.rows_ms = spent_ms;
        rendered.rows.rows = [rows = result.rows, spent_ms](int first, int last) {
            const auto start = std::chrono::steady_clock::now();
            cv::Mat made = rows(first, last);
            *spent_ms += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
            return made;
        };
    } else {
        rendered.image = whole_picture(result);
    }
}

}  // namespace puppetwarp
