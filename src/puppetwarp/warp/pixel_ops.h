#pragma once

#include <puppetwarp/warp/sampling.h>

namespace puppetwarp::detail {

//! What painting does to runs of pixels beside sampling them, for one format. Straight alpha everywhere.
struct PixelOps {
    //! Source pixels (x, y), (x + 1, y), ... Outside the picture: its border repeated; transparent when it has alpha.
    void (*copy)(const Source& source, std::int64_t x, std::int64_t y, int count, void* out);
    //! Whether some pixel's alpha is not 0. Null for outputs without alpha, as are `over` and
    //! `fade`.
    bool (*any_alpha)(const void* pixels, int count);
    //! Lays `front` over `back`, in place. \param light  for linear light, or null.
    void (*over)(const LightTables* light, const void* front, void* back, int count);
    //! Multiplies the alpha of a pixel.
    void (*fade)(void* pixel, float coverage);
};

PixelOps find_pixel_ops(const PixelFormat& format);

}  // namespace puppetwarp::detail
