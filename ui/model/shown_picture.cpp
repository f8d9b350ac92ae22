#include "model/shown_picture.h"

#include <puppetwarp/base/threads.h>

#include <opencv2/core.hpp>

#include <algorithm>
#include <cstdint>

namespace puppetwarp::ui {

namespace {

cv::Mat as_rgba(const Image& image) {
    // Where each channel goes; one without alpha stays opaque.
    static constexpr int places[5][8] = {{}, {0, 0, 0, 1, 0, 2}, {0, 0, 0, 1, 0, 2, 1, 3}, {0, 0, 1, 1, 2, 2}, {}};
    const int channels = image.pixels.channels();
    if (channels == 4) return image.pixels;
    const cv::Mat& from = image.pixels;
    cv::Mat to(from.size(), CV_MAKETYPE(from.depth(), 4), cv::Scalar::all(image.full_value()));
    cv::mixChannels(&from, 1, &to, 1, places[channels], channels == 2 ? 4 : 3);
    return to;
}

void premultiply(cv::Mat& rgba) {
    for (int y = 0; y < rgba.rows; ++y) {
        auto* pixel = rgba.ptr<cv::Vec4b>(y);
        for (int x = 0; x < rgba.cols; ++x) {
            const int alpha = pixel[x][3];
            if (alpha == 255) continue;
            for (int c = 0; c < 3; ++c) pixel[x][c] = static_cast<std::uint8_t>((pixel[x][c] * alpha + 127) / 255);
        }
    }
}

// The mean of the block of pixels that each smaller pixel stands for.
cv::Mat shrunk(const cv::Mat& rgba, const cv::Size& size) {
    cv::Mat smaller(size, CV_8UC4);
    const auto share = [](int index, int all, int parts) {
        return static_cast<int>(static_cast<std::int64_t>(index) * all / parts);
    };
    parallel_for(0, size.height, 16, [&](int first, int last) {
        for (int y = first; y < last; ++y) {
            const cv::Range rows(share(y, rgba.rows, size.height), share(y + 1, rgba.rows, size.height));
            for (int x = 0; x < size.width; ++x) {
                const cv::Range columns(share(x, rgba.cols, size.width), share(x + 1, rgba.cols, size.width));
                smaller.at<cv::Vec4b>(y, x) = cv::Vec4b(cv::mean(rgba(rows, columns)));
            }
        }
    });
    return smaller;
}

}  // namespace

cv::Mat shown_picture(const Image& image, int longest_side_px) {
    cv::Mat rgba;
    as_rgba(image).convertTo(rgba, CV_8UC4, 255.0 / image.full_value());
    if (image.has_alpha()) {
        if (rgba.data == image.pixels.data) rgba = rgba.clone();
        premultiply(rgba);
    }
    const int longest = std::max(rgba.cols, rgba.rows);
    if (longest > longest_side_px) {
        const double shrink = static_cast<double>(longest_side_px) / longest;
        const cv::Size size(std::max(1, static_cast<int>(rgba.cols * shrink)),
                            std::max(1, static_cast<int>(rgba.rows * shrink)));
        return shrunk(rgba, size);
    }
    return rgba;
}

}  // namespace puppetwarp::ui
