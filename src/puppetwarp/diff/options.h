#pragma once

#include <opencv2/core/mat.hpp>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace puppetwarp {

//! What pictures are compared by. Each has a limit, `CompareOptions::threshold`, in its own unit.
enum class DiffMetric {
    max,   //!< pixel by pixel: the largest difference of a channel; limit: the most of it, 0 to 1
    rmse,  //!< of the whole picture: root mean square over all channels; limit: the most of it, 0 to 1
    psnr,  //!< of the whole picture: peak signal to noise, dB; limit: the least of it, 0 or more
    ssim,  //!< of the whole picture: structural similarity of luma; limit: the least of it, 0 to 1
    flip   //!< pixel by pixel: the difference that a person sees; limit: the most of it, 0 to 1
};

//! `max`, `rmse`, `psnr`, `ssim`, `flip`. \throw InvalidInput  anything else.
DiffMetric diff_metric_from_name(const std::string& name);
std::string diff_metric_name(DiffMetric metric);

//! How alpha takes part. SSIM and FLIP see what a person sees of a transparent picture: it over black and over white,
//! of which the worse counts, unless alpha is ignored. (What floats hold below 0 and above 1 they see as 0 and 1.)
enum class AlphaRule {
    straight,       //!< like any channel, and colours as stored, also where alpha is 0
    premultiplied,  //!< like any channel, colours multiplied by it: what is invisible does not count
    ignore          //!< not at all; RGB compares with RGB and alpha
};

//! `straight`, `premultiplied`, `ignore`. \throw InvalidInput  anything else.
AlphaRule alpha_rule_from_name(const std::string& name);

//! Whole pixels, from the upper left corner of the expected picture.
struct PixelRect {
    int x = 0, y = 0, width = 0, height = 0;
};

//! What may differ. By default nothing: one value of one pixel fails.
//! The rules are independent: each that is set must hold.
struct CompareOptions {
    //! By default `ssim` where `min_ssim` is all that is set of what decides, else `max`.
    std::optional<DiffMetric> metric = {};
    std::optional<double> threshold = {};          //!< the metric's limit; by default no difference at all
    std::optional<std::int64_t> fail_pixels = {};  //!< of `max` and `flip`: more pixels over the threshold fail
    std::optional<double> fail_percent = {};       //!< likewise, of the compared pixels; neither is set: one fails
    //! One channel of one pixel that differs by more fails, tolerated or not; 0 to 1.
    std::optional<double> hard_fail = {};
    std::optional<double> min_ssim = {};  //!< a structural similarity below this fails; 0 to 1
    bool antialiasing = false;            //!< tolerate pixels that look antialiased (`max`, `flip`, `window_px`)
    int window_px = 0;            //!< N: N or more differing pixels in a square of N x N fail (a line across); 0: off
    double window_threshold = 0;  //!< of these: what differs by more; smaller than `threshold`, as a rule
    int shift_px = 0;             //!< compare where the pictures fit best, moved up to so far along x and y
    cv::Mat mask = {};            //!< CV_8U, one channel: compare where it is not 0; empty: everywhere
    std::vector<PixelRect> ignore = {};  //!< compare elsewhere
    AlphaRule alpha = AlphaRule::straight;
    //! Of `flip`, of the observer's view: 0.7 m away from a display of 3840 px that is 0.7 m wide.
    double pixels_per_degree = 67.02;
    bool metadata = false;  //!< differing profile, EXIF, XMP or resolution fails too; between files the orientation
};

//! The metric that decides. \see CompareOptions::metric
DiffMetric deciding_metric(const CompareOptions& options);

//! The metric's limit. \see CompareOptions::threshold
double metric_limit(const CompareOptions& options);

//! Whether a metric tells of each pixel whether it differs.
bool is_pixel_metric(DiffMetric metric);

//! \throw InvalidInput  a number outside its range, a rule that the metric cannot keep, a mask of another type.
void require_sound(const CompareOptions& options);

}  // namespace puppetwarp
