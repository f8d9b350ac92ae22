#pragma once

#include <puppetwarp/base/image.h>

#include <functional>

namespace puppetwarp {

//! A picture whose rows are made while they are written, so that it need never be in memory as a whole.
struct PictureRows {
    int width = 0;
    int height = 0;
    int type = 0;  //!< of `Image::pixels`: CV_8UC1 to CV_32FC4
    ImageMetadata metadata;
    //! \return rows [first, last) as a matrix of #rows x `width` of `type`, which nobody changes afterwards.
    //! Writers ask from the top to the bottom (PFM from the bottom to the top), some more than once for a row, WebP for
    //! all at once; one call at a time, but maybe from other threads than the writer's own. Errors of ours that it
    //! throws end the writing and are passed on.
    std::function<cv::Mat(int first, int last)> rows;
};

//! The rows of a picture in memory, which are shared, not copied.
PictureRows rows_of(const Image& image);

//! All rows at once.
Image whole_picture(const PictureRows& picture);

}  // namespace puppetwarp
