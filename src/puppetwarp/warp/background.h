#pragma once

#include <puppetwarp/base/image.h>
#include <puppetwarp/warp/warp.h>
#include <puppetwarp/warp/warp_rows.h>

#include <array>
#include <string_view>

namespace puppetwarp {

//! What stands behind a warped subject.
struct Background {
    enum class Kind {
        transparent,
        colour,
        keep,    //!< the picture as it was
        inpaint  //!< the picture, filled from around where its subject was: `fill_behind`
    } kind = Kind::transparent;
    std::array<double, 4> rgba{1, 1, 1, 1};  //!< for `colour`: in [0, 1], straight alpha, in the picture's own space
};

//! `transparent`, `keep`, `inpaint`, `#rrggbb` or `#rrggbbaa`. \throw InvalidInput  anything else.
Background background_from_name(std::string_view name);

//! Lays a warped picture over a background.
//! \param original  the picture before the warp; shown where the canvas meets it for `keep`, and for `inpaint`, when it
//!                  is to be the filled one.
//! \param canvas    which part of image space `warped` shows.
//! \param linear    whether colours are blended in linear light, as `WarpOptions::linear`.
//! Grey pictures stay grey: a colour is laid down as its luma.
//! The result has alpha when `original` has, or when some pixel does not end up opaque.
Image lay_over(const Background& background, const Image& warped, const Image& original, const Canvas& canvas,
               bool linear = false);

//! The same as rows on demand. Where only the pixels tell whether the result has alpha, rows are drawn here until that
//! is known, and again when they are asked for. `covered` of the result: false where some pixel is known to be open,
//! else none.
//! \throw MachineFault, Cancelled  as drawing rows does.
WarpedRows rows_over(const Background& background, const WarpedRows& warped, const Image& original,
                     const Canvas& canvas, bool linear = false);

}  // namespace puppetwarp
