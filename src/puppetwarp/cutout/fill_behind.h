#pragma once

#include <puppetwarp/base/image.h>
#include <puppetwarp/base/progress.h>
#include <puppetwarp/cutout/cutout.h>

namespace puppetwarp {

//! The picture without its subject: what was cut out, and 2 px and 1/250 of the diagonal around it, because subjects
//! blur into what is behind them and outlines are drawn roughly, is filled from around. Other pixels stay as they are,
//! to the bit.
//!
//! The filling goes on with what ends at the border, and is smooth where nothing around would fit.
//! Alpha is filled like a colour. The same bytes for any number of threads.
//! \param image     filled in place when no other matrix shares its pixels, else copied.
//! \param progress  hears of the stage `background`; may cancel.
//! \throw InvalidInput  the cutout is the whole picture, or nothing around it is visible.
//! Wexler et al. 2007; Barnes et al. 2009; Gortler et al. 1996 (see `PatchField`, `membrane`).
Image fill_behind(Image image, const Cutout& cutout, Progress& progress);

}  // namespace puppetwarp
