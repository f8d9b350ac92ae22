#include "canvas.h"

#include <puppetwarp/base/threads.h>

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>

namespace samples {

namespace {

void for_each_row(cv::Size size, const std::function<void(int y)>& body) {
    puppetwarp::parallel_for(0, size.height, 8, [&](int first, int last) {
        for (int y = first; y < last; ++y) body(y);
    });
}

Vec centre_of(int x, int y) {
    return {static_cast<float>(x) + 0.5F, static_cast<float>(y) + 0.5F};
}

cv::Vec3f clamped(const cv::Vec3f& colour) {
    return {std::clamp(colour[0], 0.0F, 1.0F), std::clamp(colour[1], 0.0F, 1.0F), std::clamp(colour[2], 0.0F, 1.0F)};
}

float at_clamped(const Field& values, int y, int x) {
    return values(std::clamp(y, 0, values.rows - 1), std::clamp(x, 0, values.cols - 1));
}

cv::Vec3f normal_of(const Field& height, int y, int x) {
    const float right = (at_clamped(height, y, x + 1) - at_clamped(height, y, x - 1)) / 2;
    const float down = (at_clamped(height, y + 1, x) - at_clamped(height, y - 1, x)) / 2;
    return cv::normalize(cv::Vec3f(-right, -down, 1));
}

template <class Sample>
void write_row(const Paint& premultiplied, const Field& alpha, int y, bool with_alpha, float full, cv::Mat& to) {
    auto* sample = to.ptr<Sample>(y);
    const auto rounded = [full](float value) {
        return static_cast<Sample>(std::clamp(value, 0.0F, 1.0F) * full + 0.5F);
    };
    for (int x = 0; x < to.cols; ++x) {
        const float a = alpha(y, x), divisor = with_alpha ? std::max(a, 1e-6F) : 1.0F;
        const bool visible = !with_alpha || rounded(a) > 0;
        for (int channel = 0; channel < 3; ++channel) {
            *sample++ = visible ? rounded(premultiplied(y, x)[channel] / divisor) : Sample(0);
        }
        if (with_alpha) *sample++ = rounded(a);
    }
}

}  // namespace

cv::Vec3f rgb(unsigned hex) {
    const auto channel = [hex](int shift) { return static_cast<float>((hex >> shift) & 255U) / 255; };
    return {channel(16), channel(8), channel(0)};
}

Field field(cv::Size size, const std::function<float(Vec)>& value) {
    Field result(size);
    for_each_row(size, [&](int y) {
        for (int x = 0; x < size.width; ++x) result(y, x) = value(centre_of(x, y));
    });
    return result;
}

Paint paint(cv::Size size, const std::function<cv::Vec3f(Vec)>& colour) {
    Paint result(size);
    for_each_row(size, [&](int y) {
        for (int x = 0; x < size.width; ++x) result(y, x) = colour(centre_of(x, y));
    });
    return result;
}

Field coverage(const Field& distance, float softness) {
    Field result(distance.size());
    for_each_row(distance.size(), [&](int y) {
        for (int x = 0; x < distance.cols; ++x) {
            result(y, x) = std::clamp(0.5F - distance(y, x) / softness, 0.0F, 1.0F);
        }
    });
    return result;
}

Field blurred(const Field& values, float sigma_px) {
    Field result;
    cv::GaussianBlur(values, result, {}, sigma_px, sigma_px, cv::BORDER_REPLICATE);
    return result;
}

Field moved(const Field& values, Vec by) {
    Field result(values.size(), 0.0F);
    const int dx = cvRound(by.x), dy = cvRound(by.y);
    for_each_row(values.size(), [&](int y) {
        if (y - dy < 0 || y - dy >= values.rows) return;
        for (int x = std::max(0, dx); x < std::min(values.cols, values.cols + dx); ++x) {
            result(y, x) = values(y - dy, x - dx);
        }
    });
    return result;
}

Field dome(const Field& distance, float rim_px, float height_px) {
    Field result(distance.size());
    for_each_row(distance.size(), [&](int y) {
        for (int x = 0; x < distance.cols; ++x) {
            const float from_top = 1 - std::clamp(-distance(y, x) / rim_px, 0.0F, 1.0F);
            result(y, x) = height_px * std::sqrt(1 - from_top * from_top);
        }
    });
    return result;
}

Paint lit(const Paint& colour, const Field& height, const Surface& surface) {
    static const cv::Vec3f kLight = cv::normalize(cv::Vec3f(-0.45F, -0.65F, 0.75F));
    static const cv::Vec3f kHalfWay = cv::normalize(kLight + cv::Vec3f(0, 0, 1));
    Paint result(colour.size());
    for_each_row(colour.size(), [&](int y) {
        for (int x = 0; x < colour.cols; ++x) {
            const cv::Vec3f normal = normal_of(height, y, x);
            const float shade = 1 + surface.contrast * (normal.dot(kLight) - kLight[2]);
            const float gleam = surface.highlight * std::pow(std::max(normal.dot(kHalfWay), 0.0F), surface.gloss);
            // What turns away from the lamp cools down a little instead of going black.
            const float dark = std::clamp(1 - shade, 0.0F, 1.0F);
            const cv::Vec3f tint(1 - 0.06F * dark, 1 - 0.03F * dark, 1 + 0.10F * dark);
            result(y, x) = colour(y, x).mul(tint) * std::max(shade, 0.2F) + surface.lamp * gleam;
        }
    });
    return result;
}

Canvas::Canvas(cv::Size size) : premultiplied_(size, cv::Vec3f::all(0)), alpha_(size, 0.0F) {}

void Canvas::lay(const Paint& colour, const Field& cover) {
    for_each_row(size(), [&](int y) {
        for (int x = 0; x < alpha_.cols; ++x) {
            const float a = cover(y, x);
            premultiplied_(y, x) = mix(premultiplied_(y, x), clamped(colour(y, x)), a);
            alpha_(y, x) = mix(alpha_(y, x), 1, a);
        }
    });
}

void Canvas::lay(const cv::Vec3f& colour, const Field& cover) {
    lay(Paint(size(), colour), cover);
}

void Canvas::lay_inside(const Paint& colour, const Field& cover) {
    for_each_row(size(), [&](int y) {
        for (int x = 0; x < alpha_.cols; ++x) {
            premultiplied_(y, x) = mix(premultiplied_(y, x), clamped(colour(y, x)) * alpha_(y, x), cover(y, x));
        }
    });
}

void Canvas::lay_inside(const cv::Vec3f& colour, const Field& cover) {
    lay_inside(Paint(size(), colour), cover);
}

puppetwarp::Image Canvas::image(int depth, bool with_alpha) const {
    puppetwarp::Image result;
    result.pixels.create(size(), CV_MAKETYPE(depth, with_alpha ? 4 : 3));
    for_each_row(size(), [&](int y) {
        if (depth == CV_8U) {
            write_row<std::uint8_t>(premultiplied_, alpha_, y, with_alpha, 255, result.pixels);
        } else {
            write_row<std::uint16_t>(premultiplied_, alpha_, y, with_alpha, 65535, result.pixels);
        }
    });
    return result;
}

}  // namespace samples
