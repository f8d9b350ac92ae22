#pragma once

#include "scenes.h"

#include <algorithm>
#include <cmath>
#include <functional>

// Pictures and measures that tests of the warp's quality share.
namespace puppetwarp::testing {

//! Noise of as much contrast in every octave of periods from `finest_px` up, as photographs have, and a few hard edges,
//! softened as by a lens.
inline cv::Mat natural_picture(int width, int height, double finest_px, Random& random) {
    cv::Mat sum(height, width, CV_64FC1, cv::Scalar(128));
    for (double period = finest_px; period <= width; period *= 2) {
        const int columns = static_cast<int>(width / period) + 4, rows = static_cast<int>(height / period) + 4;
        cv::Mat knots(rows, columns, CV_64FC1);
        for (int i = 0; i < rows * columns; ++i) knots.at<double>(i / columns, i % columns) = uniform(random, -40, 40);
        const auto smooth = [](double t) { return t * t * (3 - 2 * t); };
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                const double u = x / period, v = y / period;
                const int i = static_cast<int>(u), j = static_cast<int>(v);
                const double fx = smooth(u - i), fy = smooth(v - j);
                const auto knot = [&](int dx, int dy) { return knots.at<double>(j + dy, i + dx); };
                sum.at<double>(y, x) += (1 - fy) * ((1 - fx) * knot(0, 0) + fx * knot(1, 0)) +
                                        fy * ((1 - fx) * knot(0, 1) + fx * knot(1, 1));
            }
        }
    }
    for (int disc = 0; disc < 5; ++disc) {
        const double cx = uniform(random, 0, width), cy = uniform(random, 0, height);
        const double radius = uniform(random, 0.05, 0.2) * width, step = uniform(random, -60, 60);
        for (int y = 0; y < height; ++y) {
            for (int x = 0; x < width; ++x) {
                const double inside = radius - std::hypot(x + 0.5 - cx, y + 0.5 - cy);
                sum.at<double>(y, x) += step / (1 + std::exp(-inside / 0.7));
            }
        }
    }
    cv::Mat picture;
    sum.convertTo(picture, CV_8U);
    return picture;
}

//! Rings whose frequency rises from 0 in the middle to half a cycle a pixel at the middle of the sides.
inline cv::Mat zone_plate(int size) {
    cv::Mat picture(size, size, CV_8UC1);
    for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
            const double dx = x + 0.5 - size / 2.0, dy = y + 0.5 - size / 2.0;
            const double phase = M_PI * (dx * dx + dy * dy) / size;
            picture.at<std::uint8_t>(y, x) = static_cast<std::uint8_t>(std::lround(127.5 + 127.5 * std::cos(phase)));
        }
    }
    return picture;
}

//! What an 8-bit grey picture of square pixels shows on average in [left, right) x [top, bottom), which lies inside.
inline double mean_in(const cv::Mat& picture, double left, double top, double right, double bottom) {
    double sum = 0;
    for (int y = static_cast<int>(top); y < bottom; ++y) {
        const double height = std::min(bottom, y + 1.0) - std::max<double>(top, y);
        for (int x = static_cast<int>(left); x < right; ++x) {
            const double width = std::min(right, x + 1.0) - std::max<double>(left, x);
            sum += width * height * picture.at<std::uint8_t>(y, x);
        }
    }
    return sum / ((right - left) * (bottom - top));
}

//! Of 8-bit grey pixels, `margin` pixels away from the border, against the numbers that they should be.
inline double psnr(const cv::Mat& picture, int margin, const std::function<double(int x, int y)>& truth) {
    double squares = 0;
    int count = 0;
    for (int y = margin; y < picture.rows - margin; ++y) {
        for (int x = margin; x < picture.cols - margin; ++x, ++count) {
            const double difference = picture.at<std::uint8_t>(y, x) - truth(x, y);
            squares += difference * difference;
        }
    }
    return 10 * std::log10(255.0 * 255.0 * count / squares);
}

}  // namespace puppetwarp::testing
