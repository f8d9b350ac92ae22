#pragma once

#include <opencv2/core/mat.hpp>

#include <cstdint>
#include <vector>

namespace puppetwarp {

//! What a picture file carries beside its pixels; copied from input to output.
struct ImageMetadata {
    std::vector<std::uint8_t> icc;   //!< ICC profile of the colours; empty: none (sRGB is assumed)
    std::vector<std::uint8_t> exif;  //!< TIFF structure of the EXIF block, without `Exif\0\0` before it; orientation 1
    std::vector<std::uint8_t> xmp;   //!< XMP packet as in the file
    double x_pixels_per_mm = 0;      //!< physical resolution; 0: the file does not say
    double y_pixels_per_mm = 0;
};

//! A picture: pixels with the depth and the channels of the file, straight alpha, and the file's metadata.
struct Image {
    //! #rows x #cols of CV_8U (0-255), CV_16U (0-65535) or CV_32F (nominally 0-1); 1 to 4 channels:
    //! grey, grey + alpha, RGB, RGB + alpha, in this order (not OpenCV's BGR).
    cv::Mat pixels;
    ImageMetadata metadata;

    int width() const { return pixels.cols; }
    int height() const { return pixels.rows; }
    bool has_alpha() const { return pixels.channels() == 2 || pixels.channels() == 4; }
    //! Index of the alpha channel; only with `has_alpha()`.
    int alpha_channel() const { return pixels.channels() - 1; }
    //! The value of full alpha and of white: 255, 65535 or 1.
    double full_value() const { return pixels.depth() == CV_8U ? 255.0 : pixels.depth() == CV_16U ? 65535.0 : 1.0; }
};

}  // namespace puppetwarp
