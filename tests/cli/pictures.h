#pragma once

#include <puppetwarp/base/image.h>

namespace puppetwarp::tests {

//! A picture with no two equal rows or columns: noise over a gradient, seeded.
//! \param type  CV_8UC1 .. CV_16UC4. Alpha is opaque inside a disc, soft at its rim, 0 outside.
Image noise_picture(int width, int height, int type);

//! A fully opaque grey disc on transparent ground, 8-bit RGBA.
Image disc_picture(int width, int height);

}  // namespace puppetwarp::tests
