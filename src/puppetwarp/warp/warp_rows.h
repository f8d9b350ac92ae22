#pragma once

#include <puppetwarp/image/picture_rows.h>
#include <puppetwarp/warp/warp.h>

#include <optional>

namespace puppetwarp {

//! A warped picture that is drawn as its rows are asked for.
struct WarpedRows {
    PictureRows picture;
    //! Whether the mesh covers each pixel of the canvas as a whole; none: only the pixels tell.
    std::optional<bool> covered;
};

//! `warp`, to the byte, of results that need never be in memory as a whole. What it needs it keeps, the picture's
//! pixels shared.
//! \param progress  must live as long as rows are asked for.
//! \throw InvalidInput  as `warp`, at once; asking for rows throws MachineFault and Cancelled.
WarpedRows warp_rows(const Image& image, const TriangleMesh& rest, const Eigen::MatrixX2d& moved,
                     const WarpOptions& options, Progress& progress);

}  // namespace puppetwarp
