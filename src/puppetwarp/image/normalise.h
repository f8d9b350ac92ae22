#pragma once

#include <puppetwarp/image/vips_session.h>

#include <string>

namespace puppetwarp {

//! A picture as libvips opened it, brought to what an Image holds: 1 to 4 channels of grey or RGB, unsigned 8, unsigned
//! 16 or float. Lazy: nothing is decoded.
struct NormalisedPicture {
    VipsImagePtr image;
    bool recoloured = false;  //!< converted to sRGB: the file's profile no longer speaks of these pixels
};

//! \param name  the file, for messages.
//! \throw InvalidInput  other numbers (signed, complex), more than 4 channels.
NormalisedPicture normalise(VipsImagePtr image, const std::string& name);

}  // namespace puppetwarp
