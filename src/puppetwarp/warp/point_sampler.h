#pragma once

#include <puppetwarp/base/image.h>
#include <puppetwarp/base/point.h>
#include <puppetwarp/warp/pixel_ops.h>
#include <puppetwarp/warp/sampling.h>

namespace puppetwarp::detail {

//! Samples a picture place by place, as `warp` samples it run by run: all that maps know of sampling. Shares the
//! picture's pixels.
class PointSampler {
public:
    //! \param adds_alpha  what is sampled gets full alpha, which the picture has not.
    PointSampler(const Image& image, bool adds_alpha, Interpolation interpolation);

    const PixelFormat& format() const { return format_; }

    //! One pixel of the output.
    //! \param at           the place of its centre, in pixels of the picture: finite, below 2^28.
    //! \param slope        columns are what a step of one pixel to the right, and down, is in the picture: below 2^28.
    //! \param slope_noise  how far the slope may be off: so much more than a whole factor of shrinking needs no more
    //! samples.
    void sample(const Point& at, const Eigen::Matrix2d& slope, double slope_noise, void* pixel) const;

    //! The alpha of a run in [0, 1], of a picture that has it. \param run  at most `longest_run` pixels.
    void alpha(const Run& run, float* alpha) const;
    static constexpr int longest_run = 256;

private:
    void supersample(const Point& at, const Eigen::Matrix2d& slope, int samples, void* pixel) const;
    template <class T>
    void take_alpha(const void* pixels, int count, float unit, float* alpha) const;

    cv::Mat pixels_;
    SourceView source_;
    PixelFormat format_;
    Interpolation interpolation_;
    RunSampler sample_run_;
    RunSampler sample_one_;
    PixelOps ops_;
};

}  // namespace puppetwarp::detail
