#pragma once

#include <puppetwarp/base/image.h>
#include <puppetwarp/base/point.h>

#include <vector>

namespace puppetwarp {

//! Where the subject's silhouette comes from.
enum class CutoutSource {
    automatic,  //!< alpha when some pixel's alpha is below half, else the whole picture
    alpha,
    mask,     //!< another picture of the same size: white is subject
    polygon,  //!< a polygon with holes
    whole     //!< every pixel
};

struct CutoutOptions {
    CutoutSource from = CutoutSource::automatic;
    Image mask;                   //!< for `mask`: grey or colour (its luma), times its alpha if it has one
    Polyline points;              //!< for `polygon`: image pixels, either orientation
    std::vector<Polyline> holes;  //!< for `polygon`
};

//! Which pixels are the subject.
struct Cutout {
    bool whole = false;  //!< every pixel is; `matte` is empty
    //! #rows x #cols, one channel, depth CV_8U, CV_16U or CV_32F: coverage from none (0) to full (255, 65535, 1).
    cv::Mat matte;
};

//! Decides which pixels of `image` are the subject.
//! \throw InvalidInput  no alpha though asked for, nothing visible, mask of another size, polygon with fewer than
//!        three points, with a coordinate that is not finite, crossing itself, or with an empty inside.
Cutout cut_out(const Image& image, const CutoutOptions& options = {});

//! The picture with everything but the subject made transparent: alpha is multiplied by the matte (alpha cutouts
//! and whole pictures come back as they are, sharing their pixels).
Image apply_cutout(const Image& image, const Cutout& cutout);

}  // namespace puppetwarp
