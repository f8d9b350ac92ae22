#include <puppetwarp/cutout/edge_colours.h>

#include <puppetwarp/base/threads.h>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <type_traits>

namespace puppetwarp {

namespace {

constexpr int rows_a_task = 32;
constexpr int reach_px = 4;  // how far either side of an edge may be
// From this coverage on a pixel is the subject's more and more.
constexpr double mixed_coverage = 0.8;
// Sides that differ by less, as a share of full scale, tell nothing apart.
constexpr double least_contrast = 0.02;

using Colour = std::array<double, 3>;

// Pixels on one side of the edge, nearer ones counting more.
struct Side {
    Colour sum{};
    double weight = 0;

    Colour mean() const { return {sum[0] / weight, sum[1] / weight, sum[2] / weight}; }
};

double full_of(int depth) {
    return depth == CV_8U ? 255.0 : depth == CV_16U ? 65535.0 : 1.0;
}

template <class T>
class EdgeCleaner {
public:
    EdgeCleaner(const cv::Mat& pixels, const cv::Mat& coverage) : pixels_(pixels), coverage_(coverage) {
        // The outermost pixels that are covered in full may be mixed all the same.
        cv::erode(coverage >= 1, inside_, cv::Mat::ones(3, 3, CV_8U));
        outside_ = coverage <= 0;
    }

    void clean(cv::Mat& out) const {
        parallel_for(0, pixels_.rows, rows_a_task, [&](int first, int last) {
            for (int y = first; y < last; ++y) {
                for (int x = 0; x < pixels_.cols; ++x) {
                    const float coverage = coverage_.at<float>(y, x);
                    if (coverage > 0 && coverage < 1) clean(x, y, coverage, out.ptr<T>(y) + channels() * x);
                }
            }
        });
    }

private:
    static constexpr double full = std::is_floating_point_v<T> ? 1.0 : static_cast<double>(static_cast<T>(-1));

    int channels() const { return pixels_.channels(); }

    Colour colour(int x, int y) const {
        Colour result{};
        const T* pixel = pixels_.ptr<T>(y) + channels() * x;
        for (int c = 0; c < channels(); ++c) result[static_cast<std::size_t>(c)] = pixel[c] / full;
        return result;
    }

    Side side(const cv::Mat& mask, int x, int y) const {
        Side side;
        for (int j = std::max(0, y - reach_px); j <= std::min(pixels_.rows - 1, y + reach_px); ++j) {
            for (int i = std::max(0, x - reach_px); i <= std::min(pixels_.cols - 1, x + reach_px); ++i) {
                const int squared = (i - x) * (i - x) + (j - y) * (j - y);
                if (squared > reach_px * reach_px || mask.at<std::uint8_t>(j, i) == 0) continue;
                const double weight = 1.0 / (squared * squared);
                const Colour here = colour(i, j);
                for (std::size_t c = 0; c < 3; ++c) side.sum[c] += weight * here[c];
                side.weight += weight;
            }
        }
        return side;
    }

    void clean(int x, int y, double coverage, T* out) const {
        const Side inner = side(inside_, x, y), outer = side(outside_, x, y);
        if (!(inner.weight > 0 && outer.weight > 0)) return;
        const Colour here = colour(x, y), subject = inner.mean(), behind = outer.mean();
        double along = 0, length = least_contrast * least_contrast;
        for (std::size_t c = 0; c < 3; ++c) {
            const double step = subject[c] - behind[c];
            along += (here[c] - behind[c]) * step;
            length += step * step;
        }
        // How much of the pixel is what is behind, by its colour; NaN takes nothing out.
        const double share = 1 - along / length;
        if (!(share > 0)) return;
        const double amount = std::min(share, 1.0) * std::min((1 - coverage) / (1 - mixed_coverage), 1.0);
        for (std::size_t c = 0; c < static_cast<std::size_t>(channels()); ++c) {
            const double value = full * (here[c] + amount * (subject[c] - behind[c]));
            out[c] = std::is_floating_point_v<T> ? static_cast<T>(value)
                                                 : static_cast<T>(std::clamp(value + 0.5, 0.0, full));
        }
    }

    const cv::Mat& pixels_;
    const cv::Mat& coverage_;  // CV_32F, 0 to 1
    cv::Mat inside_;
    cv::Mat outside_;
};

}  // namespace

Image with_clean_edges(const Image& image, const Cutout& cutout) {
    if (cutout.whole || cutout.matte.empty() || image.has_alpha()) return image;
    cv::Mat coverage;
    cutout.matte.convertTo(coverage, CV_32F, 1 / full_of(cutout.matte.depth()));
    Image result{image.pixels.clone(), image.metadata};
    switch (image.pixels.depth()) {
        case CV_8U: EdgeCleaner<std::uint8_t>(image.pixels, coverage).clean(result.pixels); break;
        case CV_16U: EdgeCleaner<std::uint16_t>(image.pixels, coverage).clean(result.pixels); break;
        default: EdgeCleaner<float>(image.pixels, coverage).clean(result.pixels);
    }
    return result;
}

}  // namespace puppetwarp
