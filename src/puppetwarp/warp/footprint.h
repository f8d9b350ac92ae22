#pragma once

#include <puppetwarp/warp/warp.h>

#include <Eigen/Core>

namespace puppetwarp::detail {

// How a pixel is made where the picture shrinks, so that nothing aliases.
//
// A step of one pixel to the right is `a` source pixels long (the length of the map's column), and down likewise; each
// axis is looked at on its own. Up to a = 1.5 there is one sample. From there on there are ceil(a) samples side by
// side, whose distances make their variance that of the average over the pixel, less what the filter itself spreads:
//   bilinear  V(a) = (a^2 - 1.7) / 12     (in squared source pixels)
//   bicubic   V(a) = (a^2 - 0.4) / 12
//   lanczos3  V(a) = a^2 / 12
// That is between what is best for a source of uniform squares and what is best for one whose pixels are averages of a
// scene themselves (smaller by 2 / 12): within 1/300 of full scale (50 dB) of both for a = 2.7.
// Between 1.5 and 2 it rises from 0 to V(2): the blur changes without a step wherever the number of samples does.
// A pixel takes at most 64 samples (8 x 8, or 64 in a row). Where that is not enough they are taken from a level of the
// pyramid, whose pixels are means of 2 x 2, 4 x 4, ... source pixels, less the variance of these and of a filter that
// is so much wider: the lowest level on which 64 will do. So there are always more than four of a level's pixels along
// an axis of a pixel: fewer would let through what the means left of finer patterns.
struct Footprint {
    int level = 0;     //!< 0: the picture itself
    int nx = 1;        //!< samples side by side
    int ny = 1;        //!< and one below the other
    double dx_px = 0;  //!< from one to the next, in pixels of the output
    double dy_px = 0;

    int samples() const { return nx * ny; }
    //! Where sample k lies, from the pixel's centre.
    Eigen::Vector2d offset_px(int k) const {
        const int column = k % nx, row = k / nx;
        return {(column - 0.5 * (nx - 1)) * dx_px, (row - 0.5 * (ny - 1)) * dy_px};
    }
};

inline constexpr int most_samples = 64;
inline constexpr double single_sample_limit = 1.5;

//! \param jacobian   of the map from the output to the source. Beyond 2^14 it says nothing: one sample.
//! \param top_level  the highest there is.
Footprint footprint(const Eigen::Matrix2d& jacobian, Interpolation interpolation, int top_level);

}  // namespace puppetwarp::detail
