#include <puppetwarp/mesh/silhouette.h>

#include <puppetwarp/base/threads.h>
#include <puppetwarp/mesh/contour_field.h>
#include <puppetwarp/mesh/taut_string.h>

#include <opencv2/core.hpp>

#include <algorithm>
#include <cmath>

namespace puppetwarp {

namespace {

constexpr int half_sum = 8 * MatteReader::full;  // half coverage, summed with the 16 parts of the blur

// A node's value from its blurred coverage; a covered pixel that the blur would lose (a hair, a speck) keeps its own.
std::int8_t node_value(int blurred, int own) {
    const int sum = own >= half_sum && blurred < half_sum ? own : blurred;
    const int rounded = (sum - half_sum + 128) >> 8;
    return static_cast<std::int8_t>(sum >= half_sum ? std::clamp(rounded, 1, 127) : std::min(rounded, -1));
}

class CoverageRows {
public:
    CoverageRows(const MatteReader& matte, SilhouetteLevel level)
        : matte_(matte), level_(level), mask_(static_cast<std::size_t>(matte.columns())) {}

    // Coverage of a row with two empty pixels on either side.
    void read(int j, std::vector<std::uint16_t>& padded) {
        padded.assign(mask_.size() + 4, 0);
        const std::span<std::uint16_t> inner(padded.data() + 2, mask_.size());
        if (level_ == SilhouetteLevel::half) {
            matte_.coverage_row(j, inner);
        } else if (j >= 0 && j < matte_.rows()) {
            matte_.support_row(j, mask_);
            for (std::size_t i = 0; i < mask_.size(); ++i) inner[i] = mask_[i] ? MatteReader::full : 0;
        }
    }

private:
    const MatteReader& matte_;
    SilhouetteLevel level_;
    std::vector<std::uint8_t> mask_;
};

// Nodes are pixel centres, with one pixel of nothing around the picture. The blur is the 3 x 3 binomial one.
ContourField coverage_field(const MatteReader& matte, SilhouetteLevel level) {
    ContourField field(-0.5, -0.5, matte.columns() + 2, matte.rows() + 2);
    parallel_for(0, field.rows(), 64, [&](int first, int last) {
        CoverageRows rows(matte, level);
        std::vector<std::uint16_t> above, here, below, sum(static_cast<std::size_t>(field.columns()) + 2);
        rows.read(first - 2, above);
        rows.read(first - 1, here);
        for (int row = first; row < last; ++row) {
            rows.read(row, below);
            for (std::size_t i = 0; i < sum.size(); ++i) {
                sum[i] = static_cast<std::uint16_t>(above[i] + 2 * here[i] + below[i]);
            }
            std::int8_t* out = field.row(row);
            for (std::size_t i = 0; i < static_cast<std::size_t>(field.columns()); ++i) {
                out[i] = node_value(sum[i] + 2 * sum[i + 1] + sum[i + 2], 16 * here[i + 1]);
            }
            above.swap(here);
            here.swap(below);
        }
    });
    return field;
}

// A grid edge between full and no coverage tells nothing about where on it the true edge runs.
bool is_hard(const MatteReader& matte, SilhouetteLevel level, const Crossing& crossing) {
    if (level == SilhouetteLevel::support) return true;
    constexpr int nearly = MatteReader::full * 6 / 100;
    const int i = crossing.i - 1, j = crossing.j - 1;  // nodes start one pixel before the picture
    return matte.coverage(i, j) >= MatteReader::full - nearly &&
           matte.coverage(i + grid_steps[crossing.way][0], j + grid_steps[crossing.way][1]) <= nearly;
}

std::vector<Gate> gates_along(const ContourField& field, const Contour& contour, const MatteReader& matte,
                              SilhouetteLevel level) {
    const std::size_t count = contour.size();
    // Beside antialiased pixels a hard edge is one that happens to lie on the pixels' border: its place is known.
    constexpr int reach = 8;
    std::vector<int> soft_for(count, 0);  // > 0: near a soft crossing
    for (std::size_t k = 0; k < count; ++k) {
        if (!is_hard(matte, level, contour[k])) soft_for[k] = reach + 1;
    }
    for (std::size_t k = 1; k < 2 * count; ++k) {
        int& here = soft_for[k % count];
        here = std::max(here, soft_for[(k - 1) % count] - 1);
    }
    for (std::size_t k = 2 * count - 1; k > 0; --k) {
        int& here = soft_for[(k - 1) % count];
        here = std::max(here, soft_for[k % count] - 1);
    }
    std::vector<Gate> gates(count);
    for (std::size_t k = 0; k < count; ++k) {
        const Crossing& crossing = contour[k];
        const bool hard = soft_for[k] == 0;
        const double at = hard ? 0.5 : crossing.at;
        const double play = hard ? 0.499 : 0.05;
        gates[k] = {crossing_point(field, crossing, std::max(0.001, at - play)),
                    crossing_point(field, crossing, std::min(0.999, at + play)), crossing_point(field, crossing, at),
                    hard};
    }
    return gates;
}

}  // namespace

void MatteReader::coverage_row(int j, std::span<std::uint16_t> out) const {
    if (j < 0 || j >= matte_.rows) {
        std::fill(out.begin(), out.end(), std::uint16_t{0});
    } else if (matte_.depth() == CV_8U) {
        const std::uint8_t* in = matte_.ptr<std::uint8_t>(j);
        for (std::size_t i = 0; i < out.size(); ++i) out[i] = static_cast<std::uint16_t>(16 * in[i]);
    } else if (matte_.depth() == CV_16U) {
        const std::uint16_t* in = matte_.ptr<std::uint16_t>(j);
        for (std::size_t i = 0; i < out.size(); ++i) {
            out[i] = static_cast<std::uint16_t>((std::uint32_t{in[i]} * full + 32767) / 65535);
        }
    } else {
        const float* in = matte_.ptr<float>(j);
        for (std::size_t i = 0; i < out.size(); ++i) {
            const float value = in[i] > 0 ? std::min(in[i], 1.0F) : 0.0F;  // NaN counts as nothing
            out[i] = static_cast<std::uint16_t>(value * full + 0.5F);
        }
    }
}

void MatteReader::support_row(int j, std::span<std::uint8_t> out) const {
    const auto mark = [&](const auto* in) {
        for (std::size_t i = 0; i < out.size(); ++i) out[i] = in[i] > 0 ? 255 : 0;
    };
    if (matte_.depth() == CV_8U) mark(matte_.ptr<std::uint8_t>(j));
    if (matte_.depth() == CV_16U) mark(matte_.ptr<std::uint16_t>(j));
    if (matte_.depth() == CV_32F) mark(matte_.ptr<float>(j));
}

int MatteReader::coverage(int i, int j) const {
    if (!within(i, j)) return 0;
    if (matte_.depth() == CV_8U) return 16 * matte_.at<std::uint8_t>(j, i);
    if (matte_.depth() == CV_16U) return static_cast<int>(matte_.at<std::uint16_t>(j, i) * full / 65535.0 + 0.5);
    const float value = matte_.at<float>(j, i);
    return value > 0 ? static_cast<int>(std::min(value, 1.0F) * full + 0.5F) : 0;
}

bool MatteReader::covered(int i, int j) const {
    if (!within(i, j)) return false;
    if (matte_.depth() == CV_8U) return matte_.at<std::uint8_t>(j, i) > 0;
    if (matte_.depth() == CV_16U) return matte_.at<std::uint16_t>(j, i) > 0;
    return matte_.at<float>(j, i) > 0;
}

cv::Rect MatteReader::support_box() const {
    int left = columns(), right = -1, top = rows(), bottom = -1;
    std::vector<std::uint8_t> mask(static_cast<std::size_t>(columns()));
    for (int j = 0; j < rows(); ++j) {
        support_row(j, mask);
        const auto first = std::find(mask.begin(), mask.end(), std::uint8_t{255});
        if (first == mask.end()) continue;
        const auto last = std::find(mask.rbegin(), mask.rend(), std::uint8_t{255});
        left = std::min(left, static_cast<int>(first - mask.begin()));
        right = std::max(right, columns() - 1 - static_cast<int>(last - mask.rbegin()));
        top = std::min(top, j);
        bottom = j;
    }
    return right < 0 ? cv::Rect() : cv::Rect(left, top, right - left + 1, bottom - top + 1);
}

std::vector<Polyline> trace_silhouette(const MatteReader& matte, SilhouetteLevel level) {
    const ContourField field = coverage_field(matte, level);
    const std::vector<Contour> contours = trace_contours(field);
    std::vector<Polyline> silhouette(contours.size());
    parallel_for(0, static_cast<int>(contours.size()), 16, [&](int first, int last) {
        for (int k = first; k < last; ++k) {
            const auto index = static_cast<std::size_t>(k);
            silhouette[index] = straightened(gates_along(field, contours[index], matte, level));
        }
    });
    return silhouette;
}

}  // namespace puppetwarp
