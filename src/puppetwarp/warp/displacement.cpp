#include <puppetwarp/warp/displacement.h>

#include <puppetwarp/base/threads.h>
#include <puppetwarp/warp/face_map.h>
#include <puppetwarp/warp/point_sampler.h>
#include <puppetwarp/warp/spans.h>
#include <puppetwarp/warp/warp_input.h>

#include <opencv2/core.hpp>

#include <algorithm>
#include <array>
#include <cassert>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

namespace puppetwarp {

namespace {

constexpr int band_rows = 32;
constexpr int longest_run = detail::PointSampler::longest_run;

std::optional<detail::PointSampler> sampler_of(const Image& image, Interpolation interpolation) {
    using Sampler = std::optional<detail::PointSampler>;
    return image.has_alpha() ? Sampler(std::in_place, image, false, interpolation) : std::nullopt;
}

// A matte as a picture that has it as its alpha.
Image with_alpha(const cv::Mat& matte) {
    Image image;
    if (matte.empty()) return image;
    cv::merge(std::vector<cv::Mat>{cv::Mat::zeros(matte.size(), matte.type()), matte}, image.pixels);
    return image;
}

}  // namespace

struct DisplacementRows::Drawn {
    Drawn(const Image& image, const cv::Mat& matte, const TriangleMesh& rest, const Eigen::MatrixX2d& moved,
          const WarpOptions& options, double scale)
        : input(detail::checked_input(rest, moved, options, image.width(), image.height())),
          plane{input.canvas, scale, image.width(), image.height()},
          spans(input.rest, input.moved, input.canvas, options.back_faces),
          alpha(sampler_of(image, options.interpolation)),
          kept(sampler_of(with_alpha(matte), options.interpolation)) {}

    detail::WarpInput input;
    DisplacementPlane plane;
    detail::SnappedMesh spans;
    std::optional<detail::PointSampler> alpha;  // of the picture
    std::optional<detail::PointSampler> kept;   // by the cutout

    void fill_band(detail::RowRange band, int first_row, cv::Mat& rows) const;
    void fill_run(const detail::FaceMap& map, int row, int first, int count, cv::Vec3f* shown, float* weights) const;
};

DisplacementRows::DisplacementRows(const Image& image, const cv::Mat& matte, const TriangleMesh& rest,
                                   const Eigen::MatrixX2d& moved, const WarpOptions& options, double scale)
    : drawn_(std::make_unique<Drawn>(image, matte, rest, moved, options, scale)) {}

DisplacementRows::~DisplacementRows() = default;
DisplacementRows::DisplacementRows(DisplacementRows&&) noexcept = default;
DisplacementRows& DisplacementRows::operator=(DisplacementRows&&) noexcept = default;

const DisplacementPlane& DisplacementRows::plane() const {
    return drawn_->plane;
}

// \param weights  how much of each pixel is what `shown` says; null for sources without alpha.
void DisplacementRows::Drawn::fill_run(const detail::FaceMap& map, int row, int first, int count, cv::Vec3f* shown,
                                       float* weights) const {
    const double x = static_cast<double>(input.canvas.x) + first + 0.5;
    const double y = static_cast<double>(input.canvas.y) + row + 0.5;
    const detail::Run run = map.run(x, y, count);
    std::array<float, longest_run> fronts, kepts;
    if (weights != nullptr) alpha->alpha(run, fronts.data());
    if (kept) kept->alpha(run, kepts.data());
    for (int i = 0; i < count; ++i) {
        const auto k = static_cast<std::size_t>(i);
        float& left = shown[i][2];
        left = kept ? kepts[k] + left * (1 - kepts[k]) : 1;
        if (weights != nullptr) {
            // Painting a layer leaves 1 - alpha of all that is below: the order among those does not change.
            const float behind = weights[i] * (1 - fronts[k]);
            weights[i] = std::max(fronts[k], behind);
            if (fronts[k] < behind) continue;
        }
        const Point at = map.is_copy()
                             ? Point(x + i - map.shift().x(), y - map.shift().y())
                             : Point(static_cast<double>(run.u + i * run.du), static_cast<double>(run.v + i * run.dv)) /
                                       detail::fixed_one +
                                   Point(0.5, 0.5);
        const Point displacement = at - plane.place(first + i, row);
        shown[i][0] = static_cast<float>(displacement.x());
        shown[i][1] = static_cast<float>(displacement.y());
    }
}

void DisplacementRows::Drawn::fill_band(detail::RowRange band, int first_row, cv::Mat& rows) const {
    const auto width = static_cast<std::size_t>(input.canvas.width);
    constexpr float nowhere = std::numeric_limits<float>::quiet_NaN();
    for (int row = band.first; row < band.last; ++row)
        std::fill_n(rows.ptr<cv::Vec3f>(row - first_row), width, cv::Vec3f(nowhere, nowhere, 0));
    std::vector<float> weights;
    if (alpha) weights.resize(width * static_cast<std::size_t>(band.last - band.first));
    spans.for_each_triangle_in(band, [&](int triangle) {
        const detail::FaceMap map(input.rest, input.moved, triangle);
        spans.for_each_span_of(triangle, band, [&](int row, int first, int last) {
            float* const row_weights =
                weights.empty() ? nullptr : weights.data() + width * static_cast<std::size_t>(row - band.first);
            for (int x = first; x < last; x += longest_run) {
                fill_run(map, row, x, std::min(longest_run, last - x), rows.ptr<cv::Vec3f>(row - first_row) + x,
                         row_weights == nullptr ? nullptr : row_weights + x);
            }
        });
    });
}

void DisplacementRows::fill(int first_row, cv::Mat& rows) const {
    assert(rows.type() == CV_32FC3 && rows.cols == drawn_->input.canvas.width);
    parallel_for(first_row, first_row + rows.rows, band_rows, [&](int first, int last) {
        drawn_->fill_band({first, last}, first_row, rows);
    });
}

DisplacementMap displacement_map(const Image& image, const TriangleMesh& rest, const Eigen::MatrixX2d& moved,
                                 const WarpOptions& options, double scale) {
    const DisplacementRows rows(image, {}, rest, moved, options, scale);
    DisplacementMap map{rows.plane(), detail::allocate_canvas(rows.plane().canvas, CV_32FC3)};
    rows.fill(0, map.displacement);
    return map;
}

}  // namespace puppetwarp
