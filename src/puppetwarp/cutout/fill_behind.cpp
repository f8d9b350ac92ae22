#include <puppetwarp/cutout/fill_behind.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/base/threads.h>
#include <puppetwarp/cutout/exemplar_fill.h>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <type_traits>

namespace puppetwarp {

namespace {

constexpr int rows_a_task = 32;
constexpr double grown_px = 2;                // what a sharp edge blurs over
constexpr double grown_share = 1.0 / 800;     // of the picture's diagonal: large pictures are softer
constexpr int least_margin_px = 32;           // of known pixels around the hole
constexpr std::size_t most_pixels = 1 << 24;  // what is filled at full size; larger holes are filled at a part of it

[[noreturn]] void throw_nothing_around(const char* reason) {
    throw InvalidInput("background inpaint", reason, "cut the subject out of a picture that shows what is around it");
}

// The subject, grown by what of it shines into its surroundings. CV_8U
cv::Mat hole_of(const Cutout& cutout) {
    const cv::Mat subject = cutout.matte > 0;
    const int by = static_cast<int>(std::lround(grown_px + grown_share * std::hypot(subject.cols, subject.rows)));
    cv::Mat hole;
    cv::dilate(subject, hole, cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * by + 1, 2 * by + 1}));
    return hole;
}

// The hole and as much around it as the filling may be made of.
cv::Rect box_around(const cv::Mat& hole) {
    const cv::Rect box = cv::boundingRect(hole);
    const int margin = std::min(box.width, box.height) / 2 + least_margin_px;
    const cv::Rect around(box.x - margin, box.y - margin, box.width + 2 * margin, box.height + 2 * margin);
    return around & cv::Rect(0, 0, hole.cols, hole.rows);
}

// Between what pictures hold and float numbers of full scale 1, premultiplied.
template <class T>
struct Values {
    static constexpr double full = std::is_floating_point_v<T> ? 1.0 : static_cast<double>(static_cast<T>(-1));

    static float read(T value) {
        const auto number = static_cast<float>(value / full);
        return std::isfinite(number) ? number : 0.0F;
    }
    static T written(double value) {
        if constexpr (std::is_floating_point_v<T>) {
            return static_cast<T>(value);
        } else {
            return static_cast<T>(std::clamp(value * full + 0.5, 0.0, full));
        }
    }

    static void load(const T* from, int channels, float* to) {
        const bool has_alpha = channels % 2 == 0;
        const float alpha = has_alpha ? read(from[channels - 1]) : 1;
        for (int c = 0; c < channels - has_alpha; ++c) to[c] = read(from[c]) * alpha;
        if (has_alpha) to[channels - 1] = alpha;
    }

    static void store(const float* from, int channels, T* to) {
        const bool has_alpha = channels % 2 == 0;
        const double alpha = has_alpha ? static_cast<double>(from[channels - 1]) : 1;
        for (int c = 0; c < channels - has_alpha; ++c) to[c] = written(alpha > 0 ? from[c] / alpha : 0);
        if (has_alpha) to[channels - 1] = written(alpha);
    }
};

template <class T>
cv::Mat loaded(const cv::Mat& pixels) {
    const int channels = pixels.channels();
    cv::Mat values(pixels.size(), CV_MAKETYPE(CV_32F, channels));
    parallel_for(0, pixels.rows, rows_a_task, [&](int first, int last) {
        for (int y = first; y < last; ++y) {
            for (int x = 0; x < pixels.cols; ++x) {
                Values<T>::load(pixels.ptr<T>(y) + channels * x, channels, values.ptr<float>(y) + channels * x);
            }
        }
    });
    return values;
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

// Holes that are too large are filled at a part of their size.
void fill(cv::Mat& values, const cv::Mat& hole, Progress& progress) {
    if (hole.total() <= most_pixels) return fill_hole(values, hole, progress);
    const double scale = std::sqrt(static_cast<double>(most_pixels) / static_cast<double>(hole.total()));
    cv::Mat smaller, smaller_hole, filled;
    cv::resize(values, smaller, {}, scale, scale, cv::INTER_AREA);
    cv::resize(hole, smaller_hole, smaller.size(), 0, 0, cv::INTER_AREA);
    fill_hole(smaller, smaller_hole, progress);
    cv::resize(smaller, filled, values.size(), 0, 0, cv::INTER_CUBIC);
    filled.copyTo(values, hole);
}

template <class T>
void fill_pixels(cv::Mat pixels, const cv::Mat& hole, Progress& progress) {
    cv::Mat values = loaded<T>(pixels);
    if (!shows_something(values, hole)) throw_nothing_around("nothing around the subject is visible");
    fill(values, hole, progress);
    store<T>(values, hole, pixels);
}

}  // namespace

Image fill_behind(const Image& image, const Cutout& cutout, Progress& progress) {
    if (cutout.whole) throw_nothing_around("the subject is the whole picture");
    const cv::Mat hole = hole_of(cutout);
    const cv::Rect box = box_around(hole);
    Image result{image.pixels.clone(), image.metadata};
    switch (image.pixels.depth()) {
        case CV_8U: fill_pixels<std::uint8_t>(result.pixels(box), hole(box), progress); break;
        case CV_16U: fill_pixels<std::uint16_t>(result.pixels(box), hole(box), progress); break;
        default: fill_pixels<float>(result.pixels(box), hole(box), progress);
    }
    return result;
}

}  // namespace puppetwarp
