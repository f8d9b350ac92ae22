#include <puppetwarp/mesh/silhouette.h>

#include <puppetwarp/base/threads.h>
#include <puppetwarp/mesh/contour_field.h>
#include <puppetwarp/mesh/taut_string.h>

#include <opencv2/core.hpp>

#include <algorithm>
#include <array>
#include <cstring>

namespace puppetwarp {

namespace {

constexpr int half_sum = 8 * MatteReader::full;  // half coverage, summed with the 16 parts of the blur

// A node's value from its blurred coverage; a covered pixel that the blur would lose (a hair, a speck) keeps its own.
std::int8_t node_value(int blurred, int own) {
    const int sum = own >= half_sum && blurred < half_sum ? own : blurred;
    const int rounded = (sum - half_sum + 128) >> 8;
    return static_cast<std::int8_t>(sum >= half_sum ? std::clamp(rounded, 1, 127) : std::min(rounded, -1));
}

constexpr int block = 64;  // nodes that are looked at together: most of a picture is uniform

// The blocks of a band of rows, and of a row and a block more on every side.
class BlockStates {
public:
    BlockStates(const MatteReader& matte, int first_row, int last_row, int blocks)
        : first_row_(first_row - 1), stride_(blocks + 2) {
        for (int row = first_row - 1; row <= last_row; ++row) {
            for (int b = -1; b <= blocks; ++b) {
                states_.push_back(matte.uniform(row - 1, b * block - 1, (b + 1) * block - 1));
            }
        }
    }

    // What a block and everything around it have in common.
    MatteReader::Uniform around(int row, int b) const {
        const MatteReader::Uniform here = at(row, b);
        for (int j = row - 1; j <= row + 1; ++j) {
            for (int k = b - 1; k <= b + 1; ++k) {
                if (at(j, k) != here) return MatteReader::Uniform::no;
            }
        }
        return here;
    }

private:
    MatteReader::Uniform at(int row, int b) const {
        return states_[static_cast<std::size_t>(row - first_row_) * static_cast<std::size_t>(stride_) +
                       static_cast<std::size_t>(b + 1)];
    }

    int first_row_, stride_;
    std::vector<MatteReader::Uniform> states_;
};

// Coverage at a level, of pixels inside the picture or not.
void read_span(const MatteReader& matte, SilhouetteLevel level, int j, int first, std::span<std::uint16_t> out) {
    if (level == SilhouetteLevel::half) {
        matte.coverage_span(j, first, out);
        return;
    }
    std::fill(out.begin(), out.end(), std::uint16_t{0});
    const int begin = std::max(first, 0), end = std::min(first + static_cast<int>(out.size()), matte.columns());
    if (j < 0 || j >= matte.rows() || begin >= end) return;
    std::array<std::uint8_t, block + 2> mask;
    const std::size_t count = static_cast<std::size_t>(end - begin);
    matte.support_span(j, begin, std::span(mask.data(), count));
    std::uint16_t* inside = out.data() + (begin - first);
    for (std::size_t i = 0; i < count; ++i) inside[i] = mask[i] ? MatteReader::full : 0;
}

// The 3 x 3 binomial blur for some nodes of one row.
void blur_block(const MatteReader& matte, SilhouetteLevel level, int row, int first, std::span<std::int8_t> out) {
    std::array<std::array<std::uint16_t, block + 2>, 3> lines;
    const std::size_t count = out.size() + 2;
    for (int k = 0; k < 3; ++k) {
        // Nodes start one pixel before the picture, and their neighbours one before them.
        read_span(matte, level, row - 2 + k, first - 2, std::span(lines[static_cast<std::size_t>(k)].data(), count));
    }
    std::array<std::uint16_t, block + 2> sum;
    for (std::size_t i = 0; i < count; ++i) {
        sum[i] = static_cast<std::uint16_t>(lines[0][i] + 2 * lines[1][i] + lines[2][i]);
    }
    for (std::size_t i = 0; i < out.size(); ++i) {
        out[i] = node_value(sum[i] + 2 * sum[i + 1] + sum[i + 2], 16 * lines[1][i + 1]);
    }
}

// Nodes are pixel centres, with one pixel of nothing around the picture.
ContourField coverage_field(const MatteReader& matte, SilhouetteLevel level) {
    ContourField field(-0.5, -0.5, matte.columns() + 2, matte.rows() + 2);
    const int blocks = (field.columns() + block - 1) / block;
    parallel_for(0, field.rows(), 64, [&](int first_row, int last_row) {
        const BlockStates states(matte, first_row, last_row, blocks);
        for (int row = first_row; row < last_row; ++row) {
            for (int b = 0; b < blocks; ++b) {
                const MatteReader::Uniform state = states.around(row, b);
                if (state == MatteReader::Uniform::uncovered) continue;
                const int first = b * block, last = std::min(field.columns(), first + block);
                const std::span<std::int8_t> out(field.row(row) + first, static_cast<std::size_t>(last - first));
                if (state == MatteReader::Uniform::full) {
                    std::fill(out.begin(), out.end(), std::int8_t{127});
                } else {
                    blur_block(matte, level, row, first, out);
                }
            }
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

void MatteReader::coverage_span(int j, int first, std::span<std::uint16_t> out) const {
    const int begin = std::max(first, 0), end = std::min(first + static_cast<int>(out.size()), matte_.cols);
    std::fill(out.begin(), out.end(), std::uint16_t{0});
    if (j < 0 || j >= matte_.rows || begin >= end) return;
    std::uint16_t* const inside = out.data() + (begin - first);
    const auto count = static_cast<std::size_t>(end - begin);
    if (matte_.depth() == CV_8U) {
        const std::uint8_t* in = matte_.ptr<std::uint8_t>(j) + begin;
        for (std::size_t i = 0; i < count; ++i) inside[i] = static_cast<std::uint16_t>(16 * in[i]);
    } else if (matte_.depth() == CV_16U) {
        const std::uint16_t* in = matte_.ptr<std::uint16_t>(j) + begin;
        for (std::size_t i = 0; i < count; ++i) {
            inside[i] = static_cast<std::uint16_t>((std::uint32_t{in[i]} * full + 32767) / 65535);
        }
    } else {
        const float* in = matte_.ptr<float>(j) + begin;
        for (std::size_t i = 0; i < count; ++i) {
            const float value = in[i] > 0 ? std::min(in[i], 1.0F) : 0.0F;  // NaN counts as nothing
            inside[i] = static_cast<std::uint16_t>(value * full + 0.5F);
        }
    }
}

void MatteReader::support_span(int j, int first, std::span<std::uint8_t> out) const {
    const auto mark = [&](const auto* in) {
        for (std::size_t i = 0; i < out.size(); ++i) out[i] = in[i] > 0 ? 255 : 0;
    };
    if (matte_.depth() == CV_8U) mark(matte_.ptr<std::uint8_t>(j) + first);
    if (matte_.depth() == CV_16U) mark(matte_.ptr<std::uint16_t>(j) + first);
    if (matte_.depth() == CV_32F) mark(matte_.ptr<float>(j) + first);
}

MatteReader::Uniform MatteReader::uniform(int j, int first, int last) const {
    const int begin = std::max(first, 0), end = std::min(last, matte_.cols);
    if (j < 0 || j >= matte_.rows || begin >= end) return Uniform::uncovered;
    const std::size_t size = matte_.elemSize();
    const std::uint8_t* bytes = matte_.ptr<std::uint8_t>(j) + static_cast<std::size_t>(begin) * size;
    const auto more = static_cast<std::size_t>(end - begin - 1) * size;
    if (std::memcmp(bytes, bytes + size, more) != 0) return Uniform::no;
    if (!covered(begin, j)) return Uniform::uncovered;
    return coverage(begin, j) == full && begin == first && end == last ? Uniform::full : Uniform::no;
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
        if (uniform(j, 0, columns()) == Uniform::uncovered) continue;
        support_span(j, 0, mask);
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
