#pragma once

#include <puppetwarp/project/pipeline.h>
#include <puppetwarp/warp/background.h>

namespace puppetwarp {

// The end of the way of the data, shared by warps through meshes and through maps.

//! \throw InvalidInput  not a finite number above 0.
void require_scale(double scale);

//! \throw InvalidInput  a canvas of more pixels than that.
void require_result_size(const Canvas& canvas, std::int64_t max_pixels);

//! A warped picture as the puppet and the file format want it: laid over its background, and over another one where the
//! format has no alpha and that background leaves something open.
//! \param original  the picture before the warp; `options.scale` is what `warped` shows of it.
//! \param cutout    what of it was drawn.
//! \param report    its canvas is `warped`'s; `lost` is filled.
Image finished_picture(const Image& warped, const Image& original, const Cutout& cutout,
                       const Background& background, const RenderOptions& options, RenderReport& report,
                       Progress& progress);

}  // namespace puppetwarp
