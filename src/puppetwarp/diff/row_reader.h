#pragma once

#include <puppetwarp/diff/options.h>

#include <opencv2/core/mat.hpp>

#include <cstdint>
#include <vector>

namespace puppetwarp {

//! How many channels of a picture are compared.
int compared_channels(const cv::Mat& pixels, AlphaRule alpha);

//! Rows of a picture on one scale for all depths, with alpha as the rule wants it: bytes (of 8 bits alone, and not
//! premultiplied, which needs more), 16-bit integers (8 bits widened), or doubles of which 1 is full scale, integers
//! rounded to float as a float file would hold them (51 of 255 equals 0.2f). One object a thread. The picture must
//! outlive it.
template <class Value>
class RowReader {
public:
    RowReader(const cv::Mat& pixels, AlphaRule alpha);

    int channels() const { return channels_; }
    //! \return width x channels values of row y, valid until the next call.
    const Value* row(int y);

private:
    const Value* premultiplied(const Value* from);
    const Value* without_alpha(const Value* from);

    const cv::Mat& pixels_;
    AlphaRule alpha_;
    int channels_;
    std::vector<Value> widened_;  // in the common scale, where the picture's own is another one
    std::vector<Value> ruled_;    // with the rule applied
};

extern template class RowReader<std::uint8_t>;
extern template class RowReader<std::uint16_t>;
extern template class RowReader<double>;

}  // namespace puppetwarp
