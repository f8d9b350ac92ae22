#pragma once

#include <puppetwarp/diff/measure.h>

namespace puppetwarp {

//! FLIP errors over the selected pixels, 0 to 1.
struct FlipFigures {
    double mean = 0;
    double max = 0;
    int max_x = -1, max_y = -1;  //!< the first in reading order; -1: nothing differs
};

//! The difference that a person sees who flips between two pictures: LDR-FLIP of Andersson, Nilsson, Akenine-Moller,
//! Oskarsson, Astrom & Fairchild 2020 ("FLIP: A Difference Evaluator for Alternating Images"). Both pictures, taken to
//! be sRGB, are filtered in an opponent space as an eye does that sees so many pixels in a degree; their distance in
//! colour, after Hunt and HyAB, is amplified where edges or points differ. Deviations from the paper: values beyond 0
//! to 1 are cut off; transparent pictures are seen over black and over white, the larger error of a pixel counts; what
//! is not selected is taken to be the same in both. \param marks   gets `kOver` where the error exceeds `threshold` (0
//! to 1). \param errors  CV_32F of the same size for the error of each pixel, or null.
FlipFigures flip(const AlignedPair& pair, double pixels_per_degree, double threshold, cv::Mat& marks, cv::Mat* errors);

}  // namespace puppetwarp
