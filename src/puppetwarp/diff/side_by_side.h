#pragma once

#include <puppetwarp/diff/compare_files.h>

namespace puppetwarp {

//! The expected picture, the actual one and the heat map beside each other under their names, with the verdict below;
//! transparent parts over chequers. Pictures of less than 200 px are enlarged by a whole factor. 8-bit RGB.
//! \param files  compared, with the heat map where they are comparable.
Image side_by_side(const ComparedFiles& files);

}  // namespace puppetwarp
