#pragma once

#include <puppetwarp/diff/compare.h>
#include <puppetwarp/diff/measure.h>

#include <opencv2/core/mat.hpp>

#include <string>

namespace puppetwarp {

//! Why two pictures cannot be compared pixel by pixel; empty when they can.
struct Incomparable {
    std::string rule;    //!< `size` or `channels`
    std::string reason;  //!< for a person
};
Incomparable why_incomparable(const Image& expected, const Image& actual, AlphaRule alpha);

//! All that comparing finds out, pixel by pixel too.
struct Examination {
    Comparison comparison;
    cv::Rect part;  //!< of the expected picture, what lies on the actual one; what follows is of its size
    AlignedPair pair;
    cv::Mat marks;                     //!< \see kSlight; empty where the pictures are not comparable
    std::uint8_t shown_marks = kOver;  //!< which of them a heat map colours
    cv::Mat errors;                    //!< CV_32F FLIP errors, where they decide and were asked for; else empty
};

//! \param keep_errors  whether `errors` is wanted.   \throw InvalidInput  as `compare`.
Examination examine(const Image& expected, const Image& actual, const CompareOptions& options, bool keep_errors);

}  // namespace puppetwarp
