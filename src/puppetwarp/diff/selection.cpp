#include <puppetwarp/diff/selection.h>

#include <puppetwarp/base/errors.h>

#include <opencv2/core.hpp>

#include <algorithm>
#include <cstdint>
#include <sstream>

namespace puppetwarp {

namespace {

std::string size_phrase(const cv::Size& size) {
    return std::to_string(size.width) + " x " + std::to_string(size.height);
}

// Borders are computed in 64 bits: a rectangle may be as large as its numbers.
cv::Rect inside(const PixelRect& rect, const cv::Size& size) {
    const auto clamped = [](std::int64_t value, int most) {
        return static_cast<int>(std::clamp<std::int64_t>(value, 0, most));
    };
    const int left = clamped(rect.x, size.width), top = clamped(rect.y, size.height);
    return {left, top, clamped(std::int64_t{rect.x} + rect.width, size.width) - left,
            clamped(std::int64_t{rect.y} + rect.height, size.height) - top};
}

}  // namespace

cv::Mat selected_pixels(const CompareOptions& options, const cv::Size& size) {
    if (options.mask.empty() && options.ignore.empty()) return {};
    cv::Mat selected(size, CV_8U, cv::Scalar(1));
    if (!options.mask.empty()) {
        if (options.mask.size() != size) {
            throw InvalidInput(
                "mask", "it has " + size_phrase(options.mask.size()) + " pixels, the picture " + size_phrase(size),
                "make it as large as the picture");
        }
        selected.setTo(0, options.mask == 0);
    }
    for (const PixelRect& rect : options.ignore) {
        const cv::Rect part = inside(rect, size);
        if (part.empty()) {
            std::ostringstream subject;
            subject << "ignore " << rect.x << ',' << rect.y << ',' << rect.width << ',' << rect.height;
            throw InvalidInput(subject.str(), "lies outside of the picture of " + size_phrase(size) + " pixels");
        }
        selected(part).setTo(0);
    }
    return selected;
}

}  // namespace puppetwarp
