#include <puppetwarp/diff/ssim.h>

#include <puppetwarp/base/threads.h>
#include <puppetwarp/diff/seen_rows.h>

#include <opencv2/core.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

namespace puppetwarp {

namespace {

constexpr int kWindow = 11;
constexpr double kSigma_px = 1.5;
constexpr float kC1 = 0.01F * 0.01F, kC2 = 0.03F * 0.03F;
// Larger than the bands of other passes: each begins with the rows that its first window needs.
constexpr int kSsimRows = 64;
// Variances are differences of squares: values around 0 keep more of their digits.
constexpr float kMiddle = 0.5F;

// One half of a window's weights along one side: the middle one first.
struct Weights {
    int reach = 0;  // pixels to either side of the middle
    std::array<float, kWindow / 2 + 1> weight{};

    explicit Weights(int side_px) : reach(std::min((side_px - 1) / 2, kWindow / 2)) {
        std::array<double, kWindow / 2 + 1> exact{};
        double sum = 0;
        for (int i = 0; i <= reach; ++i) {
            exact[static_cast<std::size_t>(i)] = std::exp(-i * i / (2 * kSigma_px * kSigma_px));
            sum += (i == 0 ? 1 : 2) * exact[static_cast<std::size_t>(i)];
        }
        for (std::size_t i = 0; i < weight.size(); ++i) weight[i] = static_cast<float>(exact[i] / sum);
    }
};

// What SSIM needs the local means of: both lumas, the sum of their squares, their product. Rows of `width` values.
struct Moments {
    enum : std::size_t { expected, actual, squares, product, count };
    std::array<std::vector<float>, count> rows;

    explicit Moments(int width) {
        for (auto& row : rows) row.resize(static_cast<std::size_t>(width));
    }
};

void luma_of(const SeenRow& row, float* luma) {
    const float* red = row.plane(0);
    if (row.planes_count == 1) {
        for (int x = 0; x < row.width; ++x) luma[x] = red[x] - kMiddle;
        return;
    }
    const float* green = row.plane(1);
    const float* blue = row.plane(2);
    for (int x = 0; x < row.width; ++x) {
        luma[x] = 0.299F * red[x] + 0.587F * green[x] + 0.114F * blue[x] - kMiddle;
    }
}

void moments_of(const SeenRows& rows, int width, Moments& moments) {
    float* a = moments.rows[Moments::expected].data();
    float* b = moments.rows[Moments::actual].data();
    luma_of(rows.expected(), a);
    luma_of(rows.actual(), b);
    float* squares = moments.rows[Moments::squares].data();
    float* product = moments.rows[Moments::product].data();
    for (int x = 0; x < width; ++x) {
        squares[x] = a[x] * a[x] + b[x] * b[x];
        product[x] = a[x] * b[x];
    }
}

// to[x] = sum over i of weight[|i|] * from_i[x], the taps given from the first row to the last.
void weigh_rows(const std::vector<const float*>& taps, const Weights& weights, int width, float* to) {
    const auto reach = static_cast<std::size_t>(weights.reach);
    const float* middle = taps[reach];
    const float centre = weights.weight[0];
    for (int x = 0; x < width; ++x) to[x] = centre * middle[x];
    for (std::size_t i = 1; i <= reach; ++i) {
        const float* above = taps[reach - i];
        const float* below = taps[reach + i];
        const float weight = weights.weight[i];
        for (int x = 0; x < width; ++x) to[x] += weight * (above[x] + below[x]);
    }
}

// The same along a row: `width` results, of which the first has its middle at from[reach].
void weigh_columns(const float* from, const Weights& weights, int width, float* to) {
    const float* middle = from + weights.reach;
    const float centre = weights.weight[0];
    for (int x = 0; x < width; ++x) to[x] = centre * middle[x];
    for (int i = 1; i <= weights.reach; ++i) {
        const float weight = weights.weight[static_cast<std::size_t>(i)];
        for (int x = 0; x < width; ++x) to[x] += weight * (middle[x - i] + middle[x + i]);
    }
}

// Equation 13 of the paper, from local means; into the first of them.
void similarity(Moments& means, int width) {
    float* a = means.rows[Moments::expected].data();
    const float* b = means.rows[Moments::actual].data();
    const float* squares = means.rows[Moments::squares].data();
    const float* product = means.rows[Moments::product].data();
    for (int x = 0; x < width; ++x) {
        const float variances = squares[x] - (a[x] * a[x] + b[x] * b[x]);
        const float covariance = product[x] - a[x] * b[x];
        const float mean_a = a[x] + kMiddle, mean_b = b[x] + kMiddle;
        const float similar = (2 * (mean_a * mean_b) + kC1) * (2 * covariance + kC2) /
                              ((mean_a * mean_a + mean_b * mean_b + kC1) * (variances + kC2));
        a[x] = std::min(similar, 1.0F);  // rounding may lead over it
    }
}

struct Sum {
    double similarity = 0;
    std::int64_t windows = 0;
};

// Windows row by row; the last rows' moments go round in a ring.
class Band {
public:
    Band(const AlignedPair& pair, float background, const Weights& along_x, const Weights& along_y)
        : pair_(pair),
          rows_(pair, background),
          along_x_(along_x),
          along_y_(along_y),
          width_(pair.expected.cols),
          weighed_(width_),
          means_(windows()) {
        for (int i = 0; i <= 2 * along_y.reach; ++i) ring_.push_back({Moments(width_), -1});
    }

    // The similarities of the windows whose middle is in row y, from column `reach` on; null when all are 1, as of
    // rows with the same bytes.
    const float* similarities(int y) {
        const int first = y - along_y_.reach, last = y + along_y_.reach;
        for (int row = std::max(first, looked_at_ + 1); row <= last; ++row) {
            if (!is_equal(row)) last_different_ = row;
            looked_at_ = row;
        }
        if (last_different_ < first) return nullptr;
        for (int row = first; row <= last; ++row) read(row);
        for (std::size_t moment = 0; moment < Moments::count; ++moment) {
            taps_.clear();
            for (int row = first; row <= last; ++row) taps_.push_back(slot(row).moments.rows[moment].data());
            weigh_rows(taps_, along_y_, width_, weighed_.rows[moment].data());
            weigh_columns(weighed_.rows[moment].data(), along_x_, windows(), means_.rows[moment].data());
        }
        similarity(means_, windows());
        return means_.rows[Moments::expected].data();
    }

    int windows() const { return width_ - 2 * along_x_.reach; }

private:
    struct Slot {
        Moments moments;
        int row;  // whose they are; -1: nobody's
    };

    Slot& slot(int row) { return ring_[static_cast<std::size_t>(row) % ring_.size()]; }

    void read(int row) {
        if (slot(row).row == row) return;
        rows_.read(row, 0, width_);
        moments_of(rows_, width_, slot(row).moments);
        slot(row).row = row;
    }

    bool is_equal(int row) const {
        const std::size_t bytes = static_cast<std::size_t>(width_) * pair_.expected.elemSize();
        return pair_.expected.type() == pair_.actual.type() &&
               std::memcmp(pair_.expected.ptr(row), pair_.actual.ptr(row), bytes) == 0;
    }

    const AlignedPair& pair_;
    SeenRows rows_;
    const Weights& along_x_;
    const Weights& along_y_;
    int width_;
    int looked_at_ = -1;       // the last row whose bytes were compared
    int last_different_ = -1;  // of these
    std::vector<Slot> ring_;
    std::vector<const float*> taps_;
    Moments weighed_;
    Moments means_;
};

// Of each window whether it is the nearest to a selected pixel: pixels nearer to the border than a window's middle can
// come belong to the outermost windows. Empty: all count.
cv::Mat counted_windows(const cv::Mat& selected, int reach_x, int reach_y) {
    if (selected.empty()) return {};
    cv::Mat counted = cv::Mat::zeros(selected.rows - 2 * reach_y, selected.cols - 2 * reach_x, CV_8U);
    for (int y = 0; y < selected.rows; ++y) {
        const std::uint8_t* from = selected.ptr(y);
        std::uint8_t* to = counted.ptr(std::clamp(y - reach_y, 0, counted.rows - 1));
        for (int x = 0; x < selected.cols; ++x) to[std::clamp(x - reach_x, 0, counted.cols - 1)] |= from[x];
    }
    return counted;
}

void add_row(const float* similarities, int windows, const std::uint8_t* counted, Sum& sum) {
    for (int x = 0; x < windows; ++x) {
        if (counted && !counted[x]) continue;
        sum.similarity += similarities ? similarities[x] : 1;
        ++sum.windows;
    }
}

double ssim_over(const AlignedPair& pair, float background) {
    const Weights along_x(pair.expected.cols), along_y(pair.expected.rows);
    const cv::Mat counted = counted_windows(pair.selected, along_x.reach, along_y.reach);
    const int rows = pair.expected.rows - 2 * along_y.reach;
    std::vector<Sum> sums(static_cast<std::size_t>((rows + kSsimRows - 1) / kSsimRows));
    parallel_for(0, rows, kSsimRows, [&](int first, int last) {
        Band band(pair, background, along_x, along_y);
        Sum sum;
        for (int window = first; window < last; ++window) {
            add_row(band.similarities(window + along_y.reach), band.windows(),
                    counted.empty() ? nullptr : counted.ptr(window), sum);
        }
        sums[static_cast<std::size_t>(first / kSsimRows)] = sum;
    });
    Sum all;
    for (const Sum& sum : sums) {
        all.similarity += sum.similarity;
        all.windows += sum.windows;
    }
    return all.similarity / static_cast<double>(all.windows);
}

}  // namespace

double ssim(const AlignedPair& pair) {
    double least = std::numeric_limits<double>::infinity();
    for (const float background : backgrounds_of(pair)) least = std::min(least, ssim_over(pair, background));
    return least;
}

}  // namespace puppetwarp
