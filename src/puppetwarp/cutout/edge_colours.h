#pragma once

#include <puppetwarp/base/image.h>
#include <puppetwarp/cutout/cutout.h>

namespace puppetwarp {

//! The picture with the colours of what is behind the subject taken out of the subject's edge, so that none of the old
//! background comes along to a new one. A pixel on an edge shows both mixed; its share of what is behind, told by the
//! colours on either side of the edge, is replaced by what is inside.
//!
//! Only where coverage is between none and full, and both sides are a few pixels away: wide soft borders stay as they
//! are, as do pictures that have an alpha of their own, and cutouts of these.
Image with_clean_edges(const Image& image, const Cutout& cutout);

}  // namespace puppetwarp
