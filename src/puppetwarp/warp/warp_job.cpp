#include <puppetwarp/warp/warp_job.h>

#include <puppetwarp/base/threads.h>
#include <puppetwarp/warp/warp_rows.h>

#include <opencv2/core.hpp>

#include <algorithm>
#include <array>
#include <cassert>
#include <memory>

namespace puppetwarp {

namespace detail {

namespace {

constexpr int band_rows = 64;  // higher bands set triangles up less often, lower ones share out better among threads
constexpr int pixels_between_reports = 1 << 24;  // tens of milliseconds: threads wait for each other there

[[maybe_unused]] bool is_picture(const cv::Mat& pixels) {
    const int depth = pixels.depth();
    return !pixels.empty() && pixels.channels() <= 4 && (depth == CV_8U || depth == CV_16U || depth == CV_32F);
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

WarpOptions on_canvas(WarpOptions options, const Canvas& canvas) {
    options.canvas = canvas;
    return options;
}

}  // namespace

WarpJob::WarpJob(Simd simd, const Image& image, const TriangleMesh& rest, const Eigen::MatrixX2d& moved,
                 const WarpOptions& options)
    : image_(image),
      input_(checked_input(rest, moved, options, image.width(), image.height())),
      options_(on_canvas(options, input_.canvas)),
      spans_(input_.rest, input_.moved, options_.canvas, options_.back_faces),
      edges_(border_edges(input_.rest.F, spans_)),
      border_(options.interpolation == Interpolation::nearest
                  ? BorderPixels()
                  : BorderPixels(input_.rest.F, spans_, edges_, options_.frame)),
      // How many triangles hold a pixel changes at borders only.
      layers_(edges_.empty() ? spans_.layers_on_first_pixel() : -1),
      centres_covered_(edges_.empty() ? layers_ > 0 : spans_.covers_canvas()),
      format_{image.pixels.depth(), image.pixels.channels(),
              !image.has_alpha() && !(centres_covered_ && border_.empty())},
      light_(options.linear && format_.depth != CV_32F ? std::optional<LightTables>(image) : std::nullopt),
      painter_({image_.pixels, format_, light_ ? &*light_ : nullptr}, input_.rest, input_.moved,
               {spans_, border_, layers_ == 1}, options_, simd) {
    assert(is_picture(image.pixels));
}

std::optional<bool> WarpJob::covered() const {
    if (!centres_covered_) return false;
    // What borders leave of a pixel may be less than half a level.
    return border_.empty() ? std::optional(true) : std::nullopt;
}

cv::Mat WarpJob::rows(int first, int last, Progress& progress) const {
    const Canvas& canvas = options_.canvas;
    cv::Mat pixels = allocate_canvas({0, 0, canvas.width, last - first}, type());
    const CanvasRows out{pixels.data, pixels.step[0], first};
    const int rows_between_reports = band_rows * std::max(2, pixels_between_reports / canvas.width / band_rows);
    for (int begin = first; begin < last;) {
        progress.step("warp", static_cast<double>(begin) / canvas.height);
        const int end = last - begin > rows_between_reports ? begin + rows_between_reports : last;
        parallel_for(begin, end, band_rows, [&](int from, int to) { painter_.paint({from, to}, out); });
        begin = end;
    }
    if (last == canvas.height) progress.step("warp", 1);
    return pixels;
}

Image warp_with(Simd simd, const Image& image, const TriangleMesh& rest, const Eigen::MatrixX2d& moved,
                const WarpOptions& options, Progress& progress) {
    progress.step("warp", 0);
    const WarpJob job(simd, image, rest, moved, options);
    Image result{job.rows(0, job.canvas().height, progress), image.metadata};
    // Folds are borders too, but what lies over or under them may well fill the pixels that they cross.
    if (result.has_alpha() && !image.has_alpha() && !job.covered()) drop_full_alpha(result.pixels);
    return result;
}

}  // namespace detail

WarpedRows warp_rows(const Image& image, const TriangleMesh& rest, const Eigen::MatrixX2d& moved,
                     const WarpOptions& options, Progress& progress) {
    progress.step("warp", 0);
    const auto job = std::make_shared<const detail::WarpJob>(detail::best_simd(), image, rest, moved, options);
    return {{job->canvas().width, job->canvas().height, job->type(), image.metadata,
             [job, &progress](int first, int last) { return job->rows(first, last, progress); }},
            job->covered()};
}

}  // namespace puppetwarp
