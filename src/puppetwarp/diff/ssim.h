#pragma once

#include <puppetwarp/diff/measure.h>

namespace puppetwarp {

//! Structural similarity, at most 1 (Wang, Bovik, Sheikh & Simoncelli 2004, "Image quality assessment: from error
//! visibility to structural similarity"): the mean over all windows of 11 x 11 pixels that lie in the picture, weighted
//! by a Gaussian of 1.5 px, with K1 = 0.01 and K2 = 0.03. It sees luma (0.299 R + 0.587 G + 0.114 B of the values in
//! the file) at full size: neither differences of hue alone, nor values beyond 0 to 1. Where a side has less than 11
//! pixels the window is the largest odd one that fits, its weights scaled to sum 1. Of a pair with selected pixels, the
//! windows count that are nearest to one of them; elsewhere the pictures are taken to be the same. Transparent pictures
//! are seen over black and over white, the lower similarity counts.
double ssim(const AlignedPair& pair);

}  // namespace puppetwarp
