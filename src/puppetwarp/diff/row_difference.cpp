#include <puppetwarp/base/errors.h>
#include <puppetwarp/diff/row_difference.h>

#include <array>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>
#include <sstream>

namespace puppetwarp {

namespace {

std::string channels_phrase(const Image& image) {
    static constexpr std::array<const char*, 4> kPhrases{"grey", "grey with alpha", "RGB", "RGB with alpha"};
    const int channels = image.pixels.channels();
    assert(channels >= 1 && channels <= 4);
    return kPhrases[static_cast<std::size_t>(channels - 1)];
}

// Full scale of both depths is 65535 then: 255 * 257.
const std::uint16_t* in_common_scale(const cv::Mat& pixels, int y, std::vector<std::uint16_t>& buffer) {
    if (pixels.depth() == CV_16U) return pixels.ptr<std::uint16_t>(y);
    assert(pixels.depth() == CV_8U);
    const std::uint8_t* from = pixels.ptr<std::uint8_t>(y);
    for (std::size_t i = 0; i < buffer.size(); ++i) buffer[i] = static_cast<std::uint16_t>(from[i] * 257);
    return buffer.data();
}

// Integers are rounded to float, as a float file would hold them: 51 of 255 equals 0.2f.
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

std::uint16_t difference_of(std::uint16_t a, std::uint16_t b) {
    return static_cast<std::uint16_t>(a > b ? a - b : b - a);
}

double difference_of(double a, double b) {
    if (std::isnan(a) || std::isnan(b)) {
        return std::isnan(a) && std::isnan(b) ? 0 : std::numeric_limits<double>::infinity();
    }
    return a == b ? 0 : std::abs(a - b);  // infinity minus itself would be NaN
}

}  // namespace

std::string incomparable_reason(const Image& expected, const Image& actual) {
    std::ostringstream reason;
    if (expected.pixels.size() != actual.pixels.size()) {
        reason << "the sizes differ: expected " << expected.width() << " x " << expected.height() << ", actual "
               << actual.width() << " x " << actual.height();
    } else if (expected.pixels.channels() != actual.pixels.channels()) {
        reason << "the channels differ: expected " << channels_phrase(expected) << ", actual "
               << channels_phrase(actual);
    }
    return reason.str();
}

void require_sound(const CompareOptions& options) {
    if (!(options.threshold >= 0 && options.threshold <= 1)) {
        std::ostringstream subject;
        subject << "threshold " << options.threshold;
        throw InvalidInput(subject.str(), "not between 0 and 1", "give it as a share of full scale, such as 0.01");
    }
}

bool have_integers(const Image& expected, const Image& actual) {
    return expected.pixels.depth() != CV_32F && actual.pixels.depth() != CV_32F;
}

template <>
std::uint16_t largest_allowed(double threshold) {
    // By division, so that a threshold of 2/255 lets 2 of 255 (514 of 65535) pass: the product could round down.
    constexpr double full = full_difference<std::uint16_t>;
    int allowed = static_cast<int>(threshold * full);
    while (allowed < full && (allowed + 1) / full <= threshold) ++allowed;
    while (allowed > 0 && allowed / full > threshold) --allowed;
    return static_cast<std::uint16_t>(allowed);
}

template <>
double largest_allowed(double threshold) {
    return threshold;
}

template <class Difference>
RowDifference<Difference>::RowDifference(const Image& expected, const Image& actual)
    : expected_(expected.pixels), actual_(actual.pixels) {
    const auto samples = static_cast<std::size_t>(expected_.cols) * static_cast<std::size_t>(expected_.channels());
    expected_row_.resize(samples);
    actual_row_.resize(samples);
    difference_.resize(samples);
}

template <class Difference>
const Difference* RowDifference<Difference>::row(int y) {
    // Equal bytes are equal values, also of NaN.
    const std::size_t row_bytes = static_cast<std::size_t>(expected_.cols) * expected_.elemSize();
    if (expected_.depth() == actual_.depth() && std::memcmp(expected_.ptr(y), actual_.ptr(y), row_bytes) == 0) {
        return nullptr;
    }
    const Difference* a = in_common_scale(expected_, y, expected_row_);
    const Difference* b = in_common_scale(actual_, y, actual_row_);
    for (std::size_t i = 0; i < difference_.size(); ++i) difference_[i] = difference_of(a[i], b[i]);
    return difference_.data();
}

template class RowDifference<std::uint16_t>;
template class RowDifference<double>;

}  // namespace puppetwarp
