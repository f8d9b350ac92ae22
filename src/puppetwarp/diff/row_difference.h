#pragma once

#include <puppetwarp/base/image.h>
#include <puppetwarp/diff/row_reader.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace puppetwarp {

//! What differences of two pictures are: exact integers, unless one holds floats.
enum class DifferenceKind { bytes, words, reals };
DifferenceKind difference_kind(const cv::Mat& expected, const cv::Mat& actual, AlphaRule alpha);

//! Calls `work` with a zero of the type that differences of two pictures have: std::uint8_t, std::uint16_t or double.
template <class Work>
auto with_difference_of(const cv::Mat& expected, const cv::Mat& actual, AlphaRule alpha, Work&& work) {
    switch (difference_kind(expected, actual, alpha)) {
        case DifferenceKind::bytes: return work(std::uint8_t{0});
        case DifferenceKind::words: return work(std::uint16_t{0});
        default: return work(0.0);
    }
}

//! The unit of the differences: 1 is the value that full scale has in `Difference`.
template <class Difference>
constexpr double full_difference = 1;
template <>
inline constexpr double full_difference<std::uint8_t> = 255;
template <>
inline constexpr double full_difference<std::uint16_t> = 65535;

//! The largest difference that a threshold (0 to 1) still lets pass.
template <class Difference>
Difference largest_allowed(double threshold);

//! Absolute differences of one row after the other, channel by channel; keeps its buffers between rows.
//! One object a thread. The pictures must be comparable and outlive it.
template <class Difference>
class RowDifference {
public:
    RowDifference(const cv::Mat& expected, const cv::Mat& actual, AlphaRule alpha);

    int channels() const { return expected_reader_.channels(); }
    //! width x channels
    std::ptrdiff_t samples() const { return static_cast<std::ptrdiff_t>(difference_.size()); }
    //! \param selected  of each pixel of the row whether it counts (else its difference is 0), or null: all do.
    //! \return width x channels differences of row y, valid until the next call; null when nothing differs.
    const Difference* row(int y, const std::uint8_t* selected);

private:
    const cv::Mat& expected_;
    const cv::Mat& actual_;
    RowReader<Difference> expected_reader_;
    RowReader<Difference> actual_reader_;
    std::vector<Difference> difference_;
};

extern template class RowDifference<std::uint8_t>;
extern template class RowDifference<std::uint16_t>;
extern template class RowDifference<double>;

}  // namespace puppetwarp
