#include <puppetwarp/diff/row_difference.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>

namespace puppetwarp {

namespace {

template <class Integer>
Integer difference_of(Integer a, Integer b) {
    return static_cast<Integer>(a > b ? a - b : b - a);
}

double difference_of(double a, double b) {
    if (std::isnan(a) || std::isnan(b)) {
        return std::isnan(a) && std::isnan(b) ? 0 : std::numeric_limits<double>::infinity();
    }
    return a == b ? 0 : std::abs(a - b);  // infinity minus itself would be NaN
}

}  // namespace

DifferenceKind difference_kind(const cv::Mat& expected, const cv::Mat& actual, AlphaRule alpha) {
    if (expected.depth() == CV_32F || actual.depth() == CV_32F) return DifferenceKind::reals;
    const bool bytes = expected.depth() == CV_8U && actual.depth() == CV_8U;
    return bytes && alpha != AlphaRule::premultiplied ? DifferenceKind::bytes : DifferenceKind::words;
}

template <class Difference>
Difference largest_allowed(double threshold) {
    if constexpr (!std::is_integral_v<Difference>) {
        return threshold;
    } else {
        // By division, so that a threshold of 2/255 lets 2 of 255 (514 of 65535) pass: the product could round down.
        constexpr double full = full_difference<Difference>;
        int allowed = static_cast<int>(threshold * full);
        while (allowed < full && (allowed + 1) / full <= threshold) ++allowed;
        while (allowed > 0 && allowed / full > threshold) --allowed;
        return static_cast<Difference>(allowed);
    }
}

template std::uint8_t largest_allowed(double threshold);
template std::uint16_t largest_allowed(double threshold);
template double largest_allowed(double threshold);

template <class Difference>
RowDifference<Difference>::RowDifference(const cv::Mat& expected, const cv::Mat& actual, AlphaRule alpha)
    : expected_(expected),
      actual_(actual),
      expected_reader_(expected, alpha),
      actual_reader_(actual, alpha),
      difference_(static_cast<std::size_t>(expected.cols) * static_cast<std::size_t>(expected_reader_.channels())) {}

template <class Difference>
const Difference* RowDifference<Difference>::row(int y, const std::uint8_t* selected) {
    // Equal bytes are equal values, also of NaN.
    const std::size_t row_bytes = static_cast<std::size_t>(expected_.cols) * expected_.elemSize();
    if (expected_.type() == actual_.type() && std::memcmp(expected_.ptr(y), actual_.ptr(y), row_bytes) == 0) {
        return nullptr;
    }
    const Difference* a = expected_reader_.row(y);
    const Difference* b = actual_reader_.row(y);
    for (std::size_t i = 0; i < difference_.size(); ++i) difference_[i] = difference_of(a[i], b[i]);
    if (selected) {
        Difference* pixel = difference_.data();
        for (int x = 0; x < expected_.cols; ++x, pixel += channels()) {
            if (!selected[x]) std::fill_n(pixel, channels(), Difference{0});
        }
    }
    return difference_.data();
}

template class RowDifference<std::uint8_t>;
template class RowDifference<std::uint16_t>;
template class RowDifference<double>;

}  // namespace puppetwarp
