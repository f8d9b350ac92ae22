#pragma once

#include <puppetwarp/base/image.h>
#include <puppetwarp/diff/options.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace puppetwarp {

//! Two pictures compared, values on a scale of 0 to 1 so that 8 and 16 bits compare. Places are pixels of the expected
//! picture. All figures are of the compared pixels: those of the mask that are not ignored and, where the pictures were
//! shifted, that both have.
struct Comparison {
    bool same = true;
    std::string reason;                 //!< why not, for a person; empty when same
    std::vector<std::string> failed;    //!< the rules that failed: `size`, `channels`, `threshold`, `fail-pixels`,
                                        //!< `fail-percent`, `hard-fail`, `min-ssim`, `window`, `metadata`
    bool comparable = true;             //!< false: sizes or channel counts differ, no figure below `metadata` is filled
    std::vector<std::string> metadata;  //!< what differs beside the pixels, a phrase each; only when asked for
    int width = 0;                      //!< of the expected picture
    int height = 0;
    DiffMetric metric = DiffMetric::max;  //!< what decided
    double threshold = 0;                 //!< its limit
    double max = 0;                       //!< largest difference of one channel
    int max_x = -1;                       //!< where: the first in reading order; -1 when nothing differs
    int max_y = -1;
    int max_channel = -1;                 //!< in which channel
    std::vector<double> expected_at_max;  //!< the values of all channels there, straight; empty when nothing differs
    std::vector<double> actual_at_max;
    double mean = 0;  //!< mean absolute difference over all channels
    double rmse = 0;
    double psnr = 0;             //!< dB, infinite when equal
    std::optional<double> ssim;  //!< structural similarity of luma, at most 1; only where it decides
    std::optional<double> flip;  //!< mean FLIP error, 0 to 1; only where it decides
    double flip_max = 0;         //!< of one pixel
    int flip_max_x = -1, flip_max_y = -1;
    std::int64_t compared_pixels = 0;
    std::int64_t differing_pixels = 0;  //!< over the threshold of `max` or `flip`; of other metrics, all that differ
    double differing_percent = 0;       //!< of the compared pixels
    int box_x = 0, box_y = 0, box_width = 0, box_height = 0;  //!< of the differing pixels; no size: none
    std::int64_t antialiased_pixels = 0;                      //!< differ and were tolerated
    int window_pixels = 0;                                    //!< differing pixels of the densest window
    int window_x = 0, window_y = 0;                           //!< its upper left corner, the first in reading order
    int shift_x = 0, shift_y = 0;  //!< pixel (x, y) was compared with the actual picture's (x + shift_x, y + shift_y)
};

//! Compares pixel by pixel; pictures of different size or channels are different, never padded.
//! Between integers the differences are exact; against a float picture, integers are first rounded to float.
//! NaN equals only NaN, against anything else it is an infinite difference.
//! The same figures, to the bit, for any number of threads.
//! \throw InvalidInput  options that are not sound (`require_sound`), a mask of another size, a rectangle to ignore
//!        that lies outside of the picture, nothing left to compare.
Comparison compare(const Image& expected, const Image& actual, const CompareOptions& options = {});

//! A picture that shows where and how much two pictures of one size differ: the expected picture in pale grey (over
//! white), differences over the threshold from yellow (a trace) to red (a quarter of full scale) to black (full scale).
//! Tolerated antialiasing is blue, what is not compared is tinted with it. With a window, what differs by more than
//! its threshold is coloured too.
//! So that a single pixel is found in a large picture, a pale violet square surrounds what differs, as far as 1/400 of
//! the longer side (none below 400 px). 8-bit RGB, the size of `expected`.
//! \throw InvalidInput  as `compare`; sizes or channel counts differ.
Image heat_map(const Image& expected, const Image& actual, const CompareOptions& options = {});

//! Both of the above in the time of one: what they share is done once.
struct ShownComparison {
    Comparison comparison;
    Image heat_map;  //!< no pixels where the pictures are not comparable
};
ShownComparison compare_and_show(const Image& expected, const Image& actual, const CompareOptions& options = {});

}  // namespace puppetwarp
