#pragma once

#include <puppetwarp/project/pipeline.h>
#include <puppetwarp/warp/background.h>
#include <puppetwarp/warp/warp_rows.h>

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
//! \return  rows that are made as they are asked for, where nothing asks for all of them before.
PictureRows finished_picture(const WarpedRows& warped, Image original, const Cutout& cutout,
                             const Background& background, const RenderOptions& options, RenderReport& report,
                             Progress& progress);

//! Rows of the result, or all of them at once, as `options` want it.
void take_result(const PictureRows& result, const RenderOptions& options, Rendered& rendered);

}  // namespace puppetwarp
