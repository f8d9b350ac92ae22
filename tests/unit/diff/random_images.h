#pragma once

#include <puppetwarp/base/image.h>

#include <cmath>
#include <random>

namespace puppetwarp::testing {

inline double sample(const Image& image, int y, int x, int channel) {
    const int at = x * image.pixels.channels() + channel;
    switch (image.pixels.depth()) {
        case CV_8U: return image.pixels.ptr<std::uint8_t>(y)[at] / 255.0;
        case CV_16U: return image.pixels.ptr<std::uint16_t>(y)[at] / 65535.0;
        default: return image.pixels.ptr<float>(y)[at];
    }
}

//! Rounds to the nearest value of the picture's depth.
inline void set_sample(Image& image, int y, int x, int channel, double value) {
    const int at = x * image.pixels.channels() + channel;
    switch (image.pixels.depth()) {
        case CV_8U: image.pixels.ptr<std::uint8_t>(y)[at] = static_cast<std::uint8_t>(std::lround(value * 255)); break;
        case CV_16U:
            image.pixels.ptr<std::uint16_t>(y)[at] = static_cast<std::uint16_t>(std::lround(value * 65535));
            break;
        default: image.pixels.ptr<float>(y)[at] = static_cast<float>(value);
    }
}

inline Image blank_image(int width, int height, int depth, int channels) {
    Image image;
    image.pixels = cv::Mat(height, width, CV_MAKETYPE(depth, channels), cv::Scalar::all(0));
    return image;
}

inline Image random_image(int width, int height, int depth, int channels, std::mt19937& random) {
    Image image = blank_image(width, height, depth, channels);
    std::uniform_real_distribution<double> unit(0, 1);
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            for (int channel = 0; channel < channels; ++channel) set_sample(image, y, x, channel, unit(random));
        }
    }
    return image;
}

//! The same values in another depth, and about one sample in `rarity` replaced by another.
inline Image changed_image(const Image& image, int depth, int rarity, std::mt19937& random) {
    Image changed = blank_image(image.width(), image.height(), depth, image.pixels.channels());
    std::uniform_real_distribution<double> unit(0, 1);
    for (int y = 0; y < image.height(); ++y) {
        for (int x = 0; x < image.width(); ++x) {
            for (int channel = 0; channel < image.pixels.channels(); ++channel) {
                const bool change = unit(random) * rarity < 1;
                set_sample(changed, y, x, channel, change ? unit(random) : sample(image, y, x, channel));
            }
        }
    }
    return changed;
}

}  // namespace puppetwarp::testing
