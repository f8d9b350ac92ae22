#include <puppetwarp/warp/pyramid.h>

#include <puppetwarp/base/threads.h>

#include <algorithm>
#include <cmath>

namespace puppetwarp::detail {

namespace {

constexpr int band_rows = 32;
constexpr int filter_reach = 36;  // pixels of a level: half a pixel of the output, and a filter's taps

// Two rows become one of half the length. Where there is no second pixel the first one counts twice.
void halve(const float* upper, const float* lower, int width, int channels, float* out) {
    for (int x = 0; x < width; x += 2) {
        const int left = channels * x, right = x + 1 < width ? left + channels : left;
        for (int c = 0; c < channels; ++c) {
            const float sum = (upper[left + c] + upper[right + c]) + (lower[left + c] + lower[right + c]);
            *out++ = sum * 0.25F;
        }
    }
}

cv::Mat halved(const cv::Mat& level) {
    cv::Mat half((level.rows + 1) / 2, (level.cols + 1) / 2, level.type());
    parallel_for(0, half.rows, band_rows, [&](int first, int last) {
        for (int y = first; y < last; ++y) {
            halve(level.ptr<float>(2 * y), level.ptr<float>(std::min(2 * y + 1, level.rows - 1)), level.cols,
                  level.channels(), half.ptr<float>(y));
        }
    });
    return half;
}

// The first level, without a copy of the picture in floats.
cv::Mat halved(const Source& source, ReadPremultiplied read, const PixelBox& box) {
    const int width = box.x_last - box.x_first, height = box.y_last - box.y_first;
    cv::Mat half((height + 1) / 2, (width + 1) / 2, CV_32FC(source.channels));
    parallel_for(0, half.rows, band_rows, [&](int first, int last) {
        const auto size = static_cast<std::size_t>(width) * static_cast<std::size_t>(source.channels);
        std::vector<float> upper(size), lower(size);
        for (int y = first; y < last; ++y) {
            read(source, box.x_first, box.y_first + 2 * y, width, upper.data());
            read(source, box.x_first, box.y_first + std::min(2 * y + 1, height - 1), width, lower.data());
            halve(upper.data(), lower.data(), width, source.channels, half.ptr<float>(y));
        }
    });
    return half;
}

}  // namespace

Pyramid::Pyramid(const Source& source, ReadPremultiplied read, const PixelBox& box, int levels) {
    if (levels == 0 || box.x_first >= box.x_last || box.y_first >= box.y_last) return;
    // Whole pixels of the highest level.
    const auto grown = [&](int first, int last, int size) {
        const std::int64_t unit = std::int64_t{1} << levels;
        const std::int64_t begin = (first / unit - filter_reach) * unit, end = (last / unit + 1 + filter_reach) * unit;
        return std::pair(static_cast<int>(std::max<std::int64_t>(begin, 0)),
                         static_cast<int>(std::min<std::int64_t>(end, size)));
    };
    const auto [left, right] = grown(box.x_first, box.x_last, source.width);
    const auto [top, bottom] = grown(box.y_first, box.y_last, source.height);
    box_ = {left, top, right, bottom};
    levels_.push_back(halved(source, read, box_));
    while (top_level() < levels) levels_.push_back(halved(levels_.back()));
}

Source Pyramid::level(int level) const {
    const cv::Mat& pixels = levels_[static_cast<std::size_t>(level) - 1];
    Source source;
    source.data = pixels.data;
    source.step = pixels.step[0];
    source.width = pixels.cols;
    source.height = pixels.rows;
    source.channels = pixels.channels();
    source.channel_bytes = sizeof(float);
    return source;
}

ViewFrame Pyramid::frame(int level) const {
    return {box_.x_first, box_.y_first, std::int64_t{1} << level};
}

int highest_level(int width, int height) {
    int level = 0;
    while (std::int64_t{1} << level < std::max(width, height)) ++level;
    return level;
}

}  // namespace puppetwarp::detail
