#pragma once

#include <puppetwarp/diff/measure.h>

#include <cstdint>

namespace puppetwarp {

//! Marks the differing pixels that look antialiased in either picture with `kAntialiased` alone. The rule is
//! Vysniauskas's (Anti-aliased Pixel and Intensity Slope Detector, 2009), as image tests use it: a pixel that has both
//! darker and brighter neighbours and at most two equally bright ones (over the border counts as one), of which the
//! darkest or the brightest lies in a flat area, with three equal neighbours or more, in both pictures.
//! Brightness is luma over white, unless alpha is ignored.
//! \return how many.
std::int64_t tolerate_antialiased(const AlignedPair& pair, cv::Mat& marks);

}  // namespace puppetwarp
