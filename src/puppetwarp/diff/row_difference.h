#pragma once

#include <puppetwarp/base/image.h>
#include <puppetwarp/diff/compare.h>

#include <cstdint>
#include <string>
#include <vector>

namespace puppetwarp {

//! Why two pictures cannot be compared pixel by pixel, for a person; empty when they can.
std::string incomparable_reason(const Image& expected, const Image& actual);

//! \throw InvalidInput  threshold outside 0-1.
void require_sound(const CompareOptions& options);

//! Whether both pictures hold integers: then differences are 16-bit integers, exact, else doubles.
bool have_integers(const Image& expected, const Image& actual);

//! The unit of the differences: 1 is the value that full scale has in `Difference`.
template <class Difference>
constexpr double full_difference = 1;
template <>
inline constexpr double full_difference<std::uint16_t> = 65535;

//! The largest difference that a threshold (0 to 1) still lets pass.
template <class Difference>
Difference largest_allowed(double threshold);
template <>
std::uint16_t largest_allowed(double threshold);
template <>
double largest_allowed(double threshold);

//! Absolute differences of one row after the other, channel by channel; keeps its buffers between rows.
//! One object a thread. The pictures must be comparable and outlive it.
template <class Difference>
class RowDifference {
public:
    RowDifference(const Image& expected, const Image& actual);

    //! \return width x channels differences of row y, valid until the next call; null when nothing differs.
    const Difference* row(int y);

private:
    const cv::Mat& expected_;
    const cv::Mat& actual_;
    std::vector<Difference> expected_row_;  // in the common scale, where the picture's own is another one
    std::vector<Difference> actual_row_;
    std::vector<Difference> difference_;
};

extern template class RowDifference<std::uint16_t>;
extern template class RowDifference<double>;

}  // namespace puppetwarp
