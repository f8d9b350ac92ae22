#pragma once

#include <puppetwarp/base/image.h>

namespace puppetwarp {

//! A picture for a person's eyes: 8-bit RGB, over grey chequers where it is transparent; floats beyond 0 to 1 are cut
//! off.
cv::Mat display_rgb(const Image& image);

//! A picture for a page: 8-bit grey or RGB, with its alpha, shrunk by a whole factor (averaging) so that its longer
//! side is at most `longest_px`. The metadata is left behind.
struct PagePicture {
    cv::Mat pixels;
    int shrunk = 1;  //!< by so much
};
PagePicture page_picture(const Image& image, int longest_px);

}  // namespace puppetwarp
