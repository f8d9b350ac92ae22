#pragma once

#include <opencv2/core/mat.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace puppetwarp {

//! How each row of a PNG is told from its neighbours before it is packed (PNG 3rd edition, section 9).
enum class PngFilter : std::uint8_t { none = 0, sub = 1, up = 2, average = 3, paeth = 4 };

//! Turns rows of pixels into filtered rows of a PNG.
class PngRowFilter {
public:
    //! \param pixels  CV_8U or CV_16U.
    //! \param above   the picture's row above them; of no size: they begin at its top.
    PngRowFilter(cv::Mat pixels, cv::Mat above);

    //! Bytes of a filtered row, with the byte in front that names the filter.
    std::size_t row_bytes() const { return row_bytes_ + 1; }

    //! Rows [first, last) through one filter.
    std::vector<std::uint8_t> filtered(int first, int last, PngFilter filter) const;

    //! Rows [first, last), each through the filter whose differences have the smallest sum of absolute values
    //! (section 12.8).
    std::vector<std::uint8_t> filtered_adaptively(int first, int last) const;

private:
    void store_row(const std::uint8_t* row, std::uint8_t* bytes) const;

    cv::Mat pixels_;
    cv::Mat above_;
    std::size_t row_bytes_;
    std::size_t pixel_bytes_;
};

}  // namespace puppetwarp
