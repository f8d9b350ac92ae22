#include <puppetwarp/diff/row_reader.h>

#include <algorithm>
#include <cassert>

namespace puppetwarp {

namespace {

bool has_alpha(const cv::Mat& pixels) {
    return pixels.channels() % 2 == 0;
}

std::uint16_t product(std::uint16_t colour, std::uint16_t alpha) {
    return static_cast<std::uint16_t>((std::uint32_t{colour} * alpha + 32767U) / 65535U);
}

std::uint8_t product(std::uint8_t /*colour*/, std::uint8_t /*alpha*/) {
    assert(!"bytes cannot hold a product");
    return 0;
}

// What is invisible is 0, also where it is NaN or infinite.
double product(double colour, double alpha) {
    return alpha == 0 ? 0 : colour * alpha;
}

const std::uint8_t* in_common_scale(const cv::Mat& pixels, int y, std::vector<std::uint8_t>& /*buffer*/) {
    assert(pixels.depth() == CV_8U);
    return pixels.ptr<std::uint8_t>(y);
}

// Full scale of both depths is 65535 then: 255 * 257.
const std::uint16_t* in_common_scale(const cv::Mat& pixels, int y, std::vector<std::uint16_t>& buffer) {
    if (pixels.depth() == CV_16U) return pixels.ptr<std::uint16_t>(y);
    assert(pixels.depth() == CV_8U);
    const std::uint8_t* from = pixels.ptr<std::uint8_t>(y);
    for (std::size_t i = 0; i < buffer.size(); ++i) buffer[i] = static_cast<std::uint16_t>(from[i] * 257);
    return buffer.data();
}

template <class Sample>
void to_unit_scale(const Sample* from, double full, std::vector<double>& to) {
    for (std::size_t i = 0; i < to.size(); ++i) to[i] = static_cast<float>(from[i] / full);
}

const double* in_common_scale(const cv::Mat& pixels, int y, std::vector<double>& buffer) {
    switch (pixels.depth()) {
        case CV_8U: to_unit_scale(pixels.ptr<std::uint8_t>(y), 255, buffer); break;
        case CV_16U: to_unit_scale(pixels.ptr<std::uint16_t>(y), 65535, buffer); break;
        default: assert(pixels.depth() == CV_32F); to_unit_scale(pixels.ptr<float>(y), 1, buffer);
    }
    return buffer.data();
}

}  // namespace

int compared_channels(const cv::Mat& pixels, AlphaRule alpha) {
    return pixels.channels() - (alpha == AlphaRule::ignore && has_alpha(pixels) ? 1 : 0);
}

template <class Value>
RowReader<Value>::RowReader(const cv::Mat& pixels, AlphaRule alpha)
    : pixels_(pixels),
      alpha_(has_alpha(pixels) ? alpha : AlphaRule::straight),
      channels_(compared_channels(pixels, alpha)) {
    const auto columns = static_cast<std::size_t>(pixels.cols);
    widened_.resize(columns * static_cast<std::size_t>(pixels.channels()));
    if (alpha_ != AlphaRule::straight) ruled_.resize(columns * static_cast<std::size_t>(channels_));
}

template <class Value>
const Value* RowReader<Value>::row(int y) {
    const Value* values = in_common_scale(pixels_, y, widened_);
    switch (alpha_) {
        case AlphaRule::premultiplied: return premultiplied(values);
        case AlphaRule::ignore: return without_alpha(values);
        default: return values;
    }
}

template <class Value>
const Value* RowReader<Value>::premultiplied(const Value* from) {
    Value* to = ruled_.data();
    for (int x = 0; x < pixels_.cols; ++x, from += channels_, to += channels_) {
        const Value alpha = from[channels_ - 1];
        for (int c = 0; c < channels_ - 1; ++c) to[c] = product(from[c], alpha);
        to[channels_ - 1] = alpha;
    }
    return ruled_.data();
}

template <class Value>
const Value* RowReader<Value>::without_alpha(const Value* from) {
    Value* to = ruled_.data();
    for (int x = 0; x < pixels_.cols; ++x, from += channels_ + 1, to += channels_) std::copy_n(from, channels_, to);
    return ruled_.data();
}

template class RowReader<std::uint8_t>;
template class RowReader<std::uint16_t>;
template class RowReader<double>;

}  // namespace puppetwarp
