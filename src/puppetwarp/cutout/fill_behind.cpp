#include <puppetwarp/cutout/fill_behind.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/base/threads.h>
#include <puppetwarp/cutout/enlarge_filling.h>
#include <puppetwarp/cutout/exemplar_fill.h>
#include <puppetwarp/cutout/full_scale.h>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <type_traits>

namespace puppetwarp {

namespace {

constexpr int rows_a_task = 32;
constexpr int rows_a_hole_task = 512;         // many times what is looked at above and below
constexpr double grown_px = 2;                // what a sharp edge blurs over
constexpr double grown_share = 1.0 / 250;     // of the diagonal: large pictures are softer, hands draw outlines roughly
constexpr int least_margin_px = 32;           // of known pixels around the hole
constexpr std::size_t most_pixels = 1 << 20;  // that are searched for patches

[[noreturn]] void throw_nothing_around(const char* reason) {
    throw InvalidInput("background inpaint", reason, "cut the subject out of a picture that shows what is around it");
}

// The subject, grown by what of it shines into its surroundings. CV_8U
cv::Mat hole_of(const cv::Mat& matte) {
    const double by = grown_px + grown_share * std::hypot(matte.cols, matte.rows);
    const int margin = static_cast<int>(by) + 1;
    cv::Mat hole(matte.size(), CV_8U);
    parallel_for(0, matte.rows, rows_a_hole_task, [&](int first, int last) {
        const int top = std::max(0, first - margin), end = std::min(matte.rows, last + margin);
        const cv::Mat behind = matte.rowRange(top, end) <= 0;
        cv::Mat rows = hole.rowRange(first, last);
        if (cv::countNonZero(behind == 0) == 0) {
            rows.setTo(0);
            return;
        }
        cv::Mat distance;
        cv::distanceTransform(behind, distance, cv::DIST_L2, cv::DIST_MASK_PRECISE);
        cv::compare(distance.rowRange(first - top, last - top), by, rows, cv::CMP_LE);
    });
    return hole;
}

// The hole and as much around it as the filling may be made of.
cv::Rect box_around(const cv::Mat& hole) {
    const cv::Rect box = cv::boundingRect(hole);
    const int margin = std::min(box.width, box.height) / 2 + least_margin_px;
    const cv::Rect around(box.x - margin, box.y - margin, box.width + 2 * margin, box.height + 2 * margin);
    return around & cv::Rect(0, 0, hole.cols, hole.rows);
}

// Means of blocks of 2^halvings pixels along each axis.
template <class T>
cv::Mat loaded(const cv::Mat& pixels, int halvings) {
    const int channels = pixels.channels(), block = 1 << halvings;
    cv::Mat values((pixels.rows - 1) / block + 1, (pixels.cols - 1) / block + 1, CV_MAKETYPE(CV_32F, channels));
    parallel_for(0, values.rows, rows_a_task, [&](int first, int last) {
        std::array<float, 4> one{}, sum{};
        for (int y = first; y < last; ++y) {
            for (int x = 0; x < values.cols; ++x) {
                const int right = std::min((x + 1) * block, pixels.cols), low = std::min((y + 1) * block, pixels.rows);
                sum.fill(0);
                for (int j = y * block; j < low; ++j) {
                    for (int i = x * block; i < right; ++i) {
                        Values<T>::load(pixels.ptr<T>(j) + channels * i, channels, one.data());
                        for (std::size_t c = 0; c < sum.size(); ++c) sum[c] += one[c];
                    }
                }
                const auto count = static_cast<float>((right - x * block) * (low - y * block));
                float* mean = values.ptr<float>(y) + channels * x;
                for (int c = 0; c < channels; ++c) mean[c] = sum[static_cast<std::size_t>(c)] / count;
            }
        }
    });
    return values;
}

// What is not known of some pixel of a block is not known.
cv::Mat blocks_of(const cv::Mat& hole, int halvings) {
    if (halvings == 0) return hole;
    const int block = 1 << halvings;
    cv::Mat blocks((hole.rows - 1) / block + 1, (hole.cols - 1) / block + 1, CV_8U, cv::Scalar(0));
    parallel_for(0, blocks.rows, rows_a_task, [&](int first, int last) {
        for (int y = first * block; y < std::min(last * block, hole.rows); ++y) {
            const std::uint8_t* row = hole.ptr<std::uint8_t>(y);
            std::uint8_t* out = blocks.ptr<std::uint8_t>(y / block);
            for (int x = 0; x < hole.cols; ++x) out[x / block] |= row[x];
        }
    });
    return blocks;
}

template <class T>
void store(const cv::Mat& values, const cv::Mat& hole, cv::Mat& pixels) {
    const int channels = pixels.channels();
    parallel_for(0, pixels.rows, rows_a_task, [&](int first, int last) {
        for (int y = first; y < last; ++y) {
            for (int x = 0; x < pixels.cols; ++x) {
                if (hole.at<std::uint8_t>(y, x) == 0) continue;
                Values<T>::store(values.ptr<float>(y) + channels * x, channels, pixels.ptr<T>(y) + channels * x);
            }
        }
    });
}

bool shows_something(const cv::Mat& values, const cv::Mat& hole) {
    const int channels = values.channels();
    cv::Mat alpha;
    if (channels % 2 != 0) return cv::countNonZero(hole == 0) > 0;
    cv::extractChannel(values, alpha, channels - 1);
    return cv::countNonZero((alpha > 0) & (hole == 0)) > 0;
}

// The first or the second half of some work.
class Half : public Progress {
public:
    Half(Progress& all, double begun) : all_(all), begun_(begun) {}

private:
    bool cancelled() const override { return all_.cancelled(); }
    void show(std::string_view stage, double fraction) override { all_.step(stage, begun_ + fraction / 2); }

    Progress& all_;
    double begun_;
};

// Large holes are filled at a part of their size, and from that in full.
template <class T>
void fill_pixels(cv::Mat pixels, const cv::Mat& hole, Progress& progress) {
    int halvings = 0;
    while ((hole.total() >> (2 * halvings)) > most_pixels) ++halvings;
    cv::Mat values = loaded<T>(pixels, halvings);
    const cv::Mat blocks = blocks_of(hole, halvings);
    if (!shows_something(values, blocks)) throw_nothing_around("nothing around the subject is visible");
    if (halvings == 0) {
        fill_hole(values, hole, progress);
        store<T>(values, hole, pixels);
        return;
    }
    Half first(progress, 0), second(progress, 0.5);
    const HoleFilling filling = fill_hole(values, blocks, first);
    enlarge_filling(filling, values, halvings, hole, pixels, second);
}

}  // namespace

Image fill_behind(Image image, const Cutout& cutout, Progress& progress) {
    if (cutout.whole) throw_nothing_around("the subject is the whole picture");
    const cv::Mat hole = hole_of(cutout.matte);
    const cv::Rect box = box_around(hole);
    cv::Mat& pixels = image.pixels;
    const bool own = pixels.u != nullptr && pixels.u->refcount == 1;
    if (!own) pixels = pixels.clone();
    switch (pixels.depth()) {
        case CV_8U: fill_pixels<std::uint8_t>(pixels(box), hole(box), progress); break;
        case CV_16U: fill_pixels<std::uint16_t>(pixels(box), hole(box), progress); break;
        default: fill_pixels<float>(pixels(box), hole(box), progress);
    }
    return image;
}

}  // namespace puppetwarp
