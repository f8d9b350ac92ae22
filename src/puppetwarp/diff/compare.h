#pragma once

#include <puppetwarp/base/image.h>

#include <cstdint>
#include <string>

namespace puppetwarp {

struct CompareOptions {
    double threshold = 0;  //!< a pixel differs when one of its channels differs by more; 0 to 1 of full scale
};

//! Two pictures compared, values on a scale of 0 to 1 so that 8 and 16 bits compare.
struct Comparison {
    bool same = true;
    std::string reason;      //!< why not, for a person; empty when same
    bool comparable = true;  //!< false: sizes or channel counts differ, the figures below are not filled
    int width = 0;           //!< of the expected picture
    int height = 0;
    double max = 0;  //!< largest difference of one channel
    int max_x = -1;  //!< where: the first in reading order; -1 when nothing differs
    int max_y = -1;
    double mean = 0;  //!< mean absolute difference over all channels
    double rmse = 0;
    double psnr = 0;                    //!< dB, infinite when equal
    std::int64_t differing_pixels = 0;  //!< over the threshold
    double differing_percent = 0;
    int box_x = 0, box_y = 0, box_width = 0, box_height = 0;  //!< of the differing pixels; no size: none
};

//! Compares pixel by pixel, alpha like any channel; pictures of different size or channels are different, never padded.
//! Between integers the differences are exact; against a float picture, integers are first rounded to float.
//! NaN equals only NaN, against anything else it is an infinite difference. \throw InvalidInput  threshold outside 0-1.
Comparison compare(const Image& expected, const Image& actual, const CompareOptions& options = {});

//! A picture that shows where and how much two pictures of one size differ: the expected picture in pale grey (over
//! white), differences over the threshold from yellow (a trace) to red (a quarter of full scale) to black (full scale).
//! So that a single pixel is found in a large picture, a pale violet square surrounds what differs, as far as 1/400 of
//! the longer side (none below 400 px). 8-bit RGB, the size of `expected`.
//! \throw InvalidInput  sizes or channel counts differ, threshold outside 0-1.
Image heat_map(const Image& expected, const Image& actual, const CompareOptions& options = {});

}  // namespace puppetwarp
