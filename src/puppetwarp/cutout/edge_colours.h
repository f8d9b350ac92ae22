#pragma once

#include <puppetwarp/base/image.h>
#include <puppetwarp/cutout/cutout.h>

namespace puppetwarp {

//! `apply_cutout`, with the colours of what is behind the subject taken out of the subject's soft edge, so that none of
//! the old background comes along to a new one. A pixel on an edge shows both mixed; its share of what is behind, told
//! by the colours on either side of the edge, is replaced by what is inside, and no channel ends up beyond what the
//! subject has near by.
//!
//! Only where coverage is between none and full and both sides are within ten pixels: what is covered in full stays to
//! the bit, wide soft borders stay as they are, as do pictures that have an alpha of their own.
Image apply_clean_cutout(const Image& image, const Cutout& cutout);

}  // namespace puppetwarp
