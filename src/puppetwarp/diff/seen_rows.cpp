#include <puppetwarp/diff/seen_rows.h>

#include <puppetwarp/image/convert.h>

#include <algorithm>
#include <cmath>

namespace puppetwarp {

namespace {

// Leaves NaN as it is, for `settle_nan`.
float clamped(float value) {
    return value < 0 ? 0.0F : value > 1 ? 1.0F : value;
}

template <class Sample, int kChannels>
void read_samples(const Sample* from, float scale, float background, bool blends, SeenRow& row) {
    constexpr int colours = kChannels < 3 ? 1 : 3;
    for (int c = 0; c < colours; ++c) {
        float* to = row.plane(c);
        const Sample* sample = from + c;
        for (int x = 0; x < row.width; ++x) to[x] = clamped(scale * static_cast<float>(sample[x * kChannels]));
    }
    if (!blends) return;
    const Sample* alphas = from + kChannels - 1;
    for (int c = 0; c < colours; ++c) {
        float* to = row.plane(c);
        for (int x = 0; x < row.width; ++x) {
            const float alpha = clamped(scale * static_cast<float>(alphas[x * kChannels]));
            to[x] = alpha == 0 ? background : background + alpha * (to[x] - background);
        }
    }
}

template <class Sample>
void read_part(const cv::Mat& pixels, int y, int first, float scale, float background, AlphaRule alpha, SeenRow& row) {
    const int channels = pixels.channels();
    const Sample* from = pixels.ptr<Sample>(y) + static_cast<std::ptrdiff_t>(first) * channels;
    const bool blends = channels % 2 == 0 && alpha != AlphaRule::ignore;
    const auto read = channels == 1   ? read_samples<Sample, 1>
                      : channels == 2 ? read_samples<Sample, 2>
                      : channels == 3 ? read_samples<Sample, 3>
                                      : read_samples<Sample, 4>;
    read(from, scale, background, blends, row);
}

void read_row(const cv::Mat& pixels, int y, int first, int last, float background, AlphaRule alpha, SeenRow& row) {
    row.planes_count = pixels.channels() < 3 ? 1 : 3;
    row.width = last - first;
    row.planes.resize(static_cast<std::size_t>(row.planes_count) * static_cast<std::size_t>(row.width));
    switch (pixels.depth()) {
        case CV_8U: read_part<std::uint8_t>(pixels, y, first, 1.0F / 255, background, alpha, row); break;
        case CV_16U: read_part<std::uint16_t>(pixels, y, first, 1.0F / 65535, background, alpha, row); break;
        default: read_part<float>(pixels, y, first, 1, background, alpha, row);
    }
}

// NaN equals only NaN.
void settle_nan(float& expected, float& actual) {
    const bool first = std::isnan(expected), second = std::isnan(actual);
    if (!first && !second) return;
    expected = 0;
    actual = first && second ? 0 : 1;
}

bool may_be_transparent(const cv::Mat& pixels) {
    return pixels.channels() % 2 == 0 && has_transparency(pixels);
}

}  // namespace

std::vector<float> backgrounds_of(const AlignedPair& pair) {
    if (pair.alpha == AlphaRule::ignore) return {0};
    if (!may_be_transparent(pair.expected) && !may_be_transparent(pair.actual)) return {0};
    return {0, 1};
}

SeenRows::SeenRows(const AlignedPair& pair, float background) : pair_(pair), background_(background) {}

void SeenRows::read(int y, int first, int last) {
    read_row(pair_.expected, y, first, last, background_, pair_.alpha, expected_);
    read_row(pair_.actual, y, first, last, background_, pair_.alpha, actual_);
    if (const std::uint8_t* selected = pair_.selected_row(y)) {
        for (int c = 0; c < expected_.planes_count; ++c) {
            const float* from = expected_.plane(c);
            float* to = actual_.plane(c);
            for (int x = 0; x < actual_.width; ++x) to[x] = selected[first + x] ? to[x] : from[x];
        }
    }
    if (pair_.expected.depth() == CV_32F || pair_.actual.depth() == CV_32F) {
        for (std::size_t i = 0; i < expected_.planes.size(); ++i) settle_nan(expected_.planes[i], actual_.planes[i]);
    }
}

}  // namespace puppetwarp
