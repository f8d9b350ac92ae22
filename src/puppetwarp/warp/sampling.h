#pragma once

#include <puppetwarp/warp/warp.h>

#include <opencv2/core/hal/interface.h>

#include <cstddef>
#include <cstdint>

namespace puppetwarp::detail {

// How a picture is sampled. Every implementation, scalar or SIMD, gives the bytes that this says.
//
// Position. (u, v) = position - 0.5, so that whole numbers are pixel centres, in 32.32 fixed point; pixel i of a run
// lies at (u + i du, v + i dv), exactly. x = floor(u), f = u - x, of which each filter takes the leading bits.
//
// Taps. `nearest`: the pixel at floor(u + 1/2); `bilinear`: x, x + 1; `bicubic`: x - 1 .. x + 2, Catmull-Rom (a =
// -1/2). Columns and rows outside the picture repeat its border. A picture with alpha also fades there: its alpha is
// multiplied by clamp(1 - 2 d) for the distance d of the position to the picture's rectangle, each axis on its own
// (`nearest`: by 0 outside). So inside its rectangle a picture never turns translucent, a subject cut off by the border
// is not smeared, and a copied pixel (d = 1/2) and its sampled neighbour meet.
//
// Opaque taps (no alpha, or full alpha in every tap and no fading), 8 bits, rows first:
//   bilinear   values in Q7, f in Q15 (truncated); lerp(a, b, f) = a + ((b - a) f + 2^14 >> 15), first between the
//              rows, then between the columns; result (value + 64) >> 7.
//   bicubic    f rounded to 1/1024; weights in Q14 from a table, each four of sum 2^14; the sum over rows is rounded
//              to Q6, the sum over columns to whole levels, and clamped.
// Opaque taps, 16 bits and float: as binary32, f in 23 bits (truncated), rows first:
//   bilinear   a + (b - a) f.
//   bicubic    p1 + (p0 - p1) w0 + (p2 - p1) w2 + (p3 - p1) w3, added from the left; w = cubic_weights(f).
//   Whole numbers: floor(value + 1/2), clamped.
// Translucent taps: colour is multiplied by alpha (as numbers of the picture, without division), then as for 16 bits
//   and float in all depths; colour is divided by the unrounded alpha; then alpha is clamped to [0, full] and faded.
//   Alpha that rounds to 0 (float: below 2^-20) gives all zeros.

//! The picture that is read. Rows are `step` bytes apart.
struct SourceView {
    const std::uint8_t* data = nullptr;
    std::size_t step = 0;
    int width = 0;
    int height = 0;
};

inline constexpr double fixed_one = 4294967296.0;

//! Consecutive output pixels of one row and one triangle; 32.32 fixed point.
struct Run {
    std::int64_t u = 0, v = 0, du = 0, dv = 0;
    int count = 0;
};

//! Pixels of one run, one after the other, straight alpha, into `out`.
using RunSampler = void (*)(const SourceView& source, const Run& run, void* out);

//! What a picture's pixels are, and whether the output gets an alpha channel that the source has not.
struct PixelFormat {
    int depth = 0;     //!< CV_8U, CV_16U or CV_32F
    int channels = 1;  //!< of the source
    bool adds_alpha = false;

    int out_channels() const { return channels + (adds_alpha ? 1 : 0); }
    bool out_has_alpha() const { return out_channels() % 2 == 0; }
    std::size_t channel_bytes() const { return depth == CV_8U ? 1 : depth == CV_16U ? 2 : 4; }
    std::size_t out_bytes() const { return channel_bytes() * static_cast<std::size_t>(out_channels()); }
    std::size_t source_bytes() const { return channel_bytes() * static_cast<std::size_t>(channels); }
};

//! Instruction sets that samplers are written for.
enum class Simd { scalar, sse41, avx2 };

//! The best that this processor has.
Simd best_simd();

//! The sampler for a format; the widest one there is up to `simd`. \param source  decides what SIMD can address.
RunSampler find_run_sampler(const PixelFormat& format, Interpolation interpolation, Simd simd,
                            const SourceView& source);

//! The portable sampler.
RunSampler find_scalar_sampler(const PixelFormat& format, Interpolation interpolation);

//! 8-bit RGB and RGBA, bilinear and bicubic; null for others, and where the program is built for another processor.
RunSampler find_sse41_sampler(const PixelFormat& format, Interpolation interpolation);
RunSampler find_avx2_sampler(const PixelFormat& format, Interpolation interpolation);

//! Catmull-Rom weights in Q14: 1025 phases of 4.
const std::int16_t* cubic_weight_table();

}  // namespace puppetwarp::detail
