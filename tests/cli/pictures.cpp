#include "pictures.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace puppetwarp::tests {

namespace {

// 1 inside a disc in the middle, falling to 0 over `soft_px`.
double disc(int x, int y, int width, int height, double soft_px) {
    const double radius = 0.4 * std::min(width, height);
    const double distance = std::hypot(x + 0.5 - width / 2.0, y + 0.5 - height / 2.0);
    return std::clamp((radius - distance) / soft_px + 0.5, 0.0, 1.0);
}

template <typename Value>
void fill(Image& image, double full) {
    std::mt19937 random(7);
    const int channels = image.pixels.channels();
    for (int y = 0; y < image.height(); ++y) {
        Value* row = image.pixels.ptr<Value>(y);
        for (int x = 0; x < image.width(); ++x) {
            const double alpha = image.has_alpha() ? disc(x, y, image.width(), image.height(), 6) : 1.0;
            for (int c = 0; c < channels; ++c) {
                const double noise = static_cast<double>(random() % 1024) / 1023;
                const double value =
                    image.has_alpha() && c == channels - 1 ? alpha : 0.7 * noise + 0.3 * x / image.width();
                row[x * channels + c] = static_cast<Value>(std::lround(value * full));
            }
        }
    }
}

}  // namespace

Image noise_picture(int width, int height, int type) {
    Image image;
    image.pixels = cv::Mat(height, width, type);
    if (image.pixels.depth() == CV_8U) {
        fill<std::uint8_t>(image, 255);
    } else {
        fill<std::uint16_t>(image, 65535);
    }
    return image;
}

Image disc_picture(int width, int height) {
    Image image;
    image.pixels = cv::Mat(height, width, CV_8UC4);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const auto alpha = static_cast<std::uint8_t>(std::lround(255 * disc(x, y, width, height, 1)));
            image.pixels.at<cv::Vec4b>(y, x) = cv::Vec4b(120, 130, 140, alpha);
        }
    }
    return image;
}

}  // namespace puppetwarp::tests
