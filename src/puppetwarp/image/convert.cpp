#include <puppetwarp/image/convert.h>

#include <puppetwarp/base/threads.h>

#include <algorithm>
#include <cstdint>
#include <cstring>

namespace puppetwarp {

namespace {

constexpr int rows_a_range = 64;

template <typename T>
constexpr double full_value_of() {
    return std::is_floating_point_v<T> ? 1.0 : static_cast<double>(std::numeric_limits<T>::max());
}

template <typename To>
To from_unit(double value) {
    if constexpr (std::is_floating_point_v<To>) {
        return static_cast<To>(value);
    } else {
        // The comparison is written so that NaN becomes 0.
        const double clamped = value > 0 ? std::min(value, 1.0) : 0.0;
        return static_cast<To>(clamped * full_value_of<To>() + 0.5);
    }
}

template <typename Body>
void for_rows(int rows, const Body& body) {
    parallel_for(0, rows, rows_a_range, [&](int first, int last) {
        for (int y = first; y < last; ++y) body(y);
    });
}

// Calls `body` with a value of the C++ type of the depth.
template <typename Body>
void with_type_of(int depth, const Body& body) {
    switch (depth) {
        case CV_8U: body(std::uint8_t{}); return;
        case CV_16U: body(std::uint16_t{}); return;
        default: CV_Assert(depth == CV_32F); body(float{});
    }
}

cv::Mat over_white(const cv::Mat& pixels) {
    const int colours = pixels.channels() - 1;
    cv::Mat flat(pixels.size(), CV_MAKETYPE(pixels.depth(), colours));
    with_type_of(pixels.depth(), [&](auto zero) {
        using T = decltype(zero);
        constexpr double full = full_value_of<T>();
        for_rows(pixels.rows, [&](int y) {
            const T* from = pixels.ptr<T>(y);
            T* to = flat.ptr<T>(y);
            for (int x = 0; x < pixels.cols; ++x, from += colours + 1, to += colours) {
                const double alpha = from[colours] / full;
                for (int c = 0; c < colours; ++c) {
                    // Opaque pixels pass as they are, floats above white included.
                    to[c] = alpha >= 1 ? from[c] : from_unit<T>(from[c] / full * alpha + (1 - alpha));
                }
            }
        });
    });
    return flat;
}

cv::Mat to_grey(const cv::Mat& pixels) {
    const int alpha = pixels.channels() - 3;
    cv::Mat grey(pixels.size(), CV_MAKETYPE(pixels.depth(), 1 + alpha));
    with_type_of(pixels.depth(), [&](auto zero) {
        using T = decltype(zero);
        constexpr double full = full_value_of<T>();
        for_rows(pixels.rows, [&](int y) {
            const T* from = pixels.ptr<T>(y);
            T* to = grey.ptr<T>(y);
            for (int x = 0; x < pixels.cols; ++x, from += 3 + alpha, to += 1 + alpha) {
                to[0] = from_unit<T>((0.2126 * from[0] + 0.7152 * from[1] + 0.0722 * from[2]) / full);
                if (alpha != 0) to[1] = from[3];
            }
        });
    });
    return grey;
}

}  // namespace

bool has_transparency(const cv::Mat& pixels) {
    const int channels = pixels.channels();
    if (channels != 2 && channels != 4) return false;
    bool found = false;
    with_type_of(pixels.depth(), [&](auto zero) {
        using T = decltype(zero);
        for (int y = 0; y < pixels.rows && !found; ++y) {
            const T* row = pixels.ptr<T>(y);
            for (int x = 0; x < pixels.cols; ++x) found |= row[x * channels + channels - 1] < full_value_of<T>();
        }
    });
    return found;
}

bool profile_fits(const std::vector<std::uint8_t>& icc, int channels) {
    // ICC.1: bytes 16 to 19 of the header are the colour space of the device side.
    if (icc.size() < 128) return false;
    return std::memcmp(icc.data() + 16, channels <= 2 ? "GRAY" : "RGB ", 4) == 0;
}

cv::Mat to_depth(const cv::Mat& pixels, int depth) {
    if (pixels.depth() == depth) return pixels;
    cv::Mat converted(pixels.size(), CV_MAKETYPE(depth, pixels.channels()));
    const int values = pixels.cols * pixels.channels();
    with_type_of(pixels.depth(), [&](auto from_zero) {
        with_type_of(depth, [&](auto to_zero) {
            using From = decltype(from_zero);
            using To = decltype(to_zero);
            for_rows(pixels.rows, [&](int y) {
                const From* from = pixels.ptr<From>(y);
                To* to = converted.ptr<To>(y);
                for (int i = 0; i < values; ++i) to[i] = from_unit<To>(from[i] / full_value_of<From>());
            });
        });
    });
    return converted;
}

cv::Mat fit_to_format(const cv::Mat& pixels, const FormatTraits& format) {
    cv::Mat fitted = pixels;
    const int channels = fitted.channels();
    if (!format.alpha && (channels == 2 || channels == 4)) fitted = over_white(fitted);
    if (!format.colour && fitted.channels() >= 3) fitted = to_grey(fitted);
    const bool floats_only = format.floats && !format.bits16;
    if (floats_only) {
        fitted = to_depth(fitted, CV_32F);
    } else if (fitted.depth() == CV_32F && !format.floats) {
        fitted = to_depth(fitted, format.bits16 ? CV_16U : CV_8U);
    } else if (fitted.depth() == CV_16U && !format.bits16) {
        fitted = to_depth(fitted, CV_8U);
    }
    return fitted.isContinuous() ? fitted : fitted.clone();
}

PictureRows fit_to_format(const PictureRows& picture, const FormatTraits& format) {
    const int type = fit_to_format(cv::Mat::zeros(1, 1, picture.type), format).type();
    if (type == picture.type) return picture;
    PictureRows fitted = picture;
    fitted.type = type;
    fitted.rows = [rows = picture.rows, &format](int first, int last) {
        return fit_to_format(rows(first, last), format);
    };
    return fitted;
}

}  // namespace puppetwarp
