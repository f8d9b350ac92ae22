#pragma once

#include <puppetwarp/base/image.h>
#include <puppetwarp/base/point.h>
#include <puppetwarp/warp/batch.h>
#include <puppetwarp/warp/footprint.h>
#include <puppetwarp/warp/light.h>
#include <puppetwarp/warp/pixel_ops.h>
#include <puppetwarp/warp/pyramid.h>
#include <puppetwarp/warp/sampling.h>

#include <opencv2/core/mat.hpp>

#include <memory>
#include <mutex>

namespace puppetwarp::detail {

//! Samples a picture place by place, as `warp` samples it run by run: all that maps know of sampling. Shares the
//! picture's pixels.
class PointSampler {
public:
    //! \param adds_alpha  what is sampled gets full alpha, which the picture has not.
    //! \param linear      in linear light, as `WarpOptions::linear`.
    PointSampler(const Image& image, bool adds_alpha, Interpolation interpolation, bool linear = false);

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
    void sample_several(const Point& at, const Eigen::Matrix2d& slope, const Footprint& shape, void* pixel) const;
    void sample_one(const Run& at, void* pixel) const;
    const Pyramid& pyramid() const;
    template <class T>
    void take_alpha(const void* pixels, int count, float unit, float* alpha) const;

    cv::Mat pixels_;
    PixelFormat format_;
    std::unique_ptr<LightTables> light_;
    Source source_;
    Interpolation interpolation_;
    Samplers samplers_;
    SampledView single_;
    Sampler level_sampler_;
    PixelOps ops_;
    int top_level_;
    mutable std::once_flag pyramid_made_;  // by the first place that needs it
    mutable Pyramid pyramid_;
};

}  // namespace puppetwarp::detail
