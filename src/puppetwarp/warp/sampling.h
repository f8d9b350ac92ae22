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
// -1/2); `lanczos3`: x - 2 .. x + 3, sinc(t) sinc(t / 3), divided by the sum of the six; then a hundredth at most
// is moved between the two in the middle so that their mean lies at f: constants stay constant and ramps stay ramps.
// Columns and rows outside the picture repeat its border. A picture with alpha also fades there: its alpha is
// multiplied by clamp(1 - 2 d) for the distance d of the position to the picture's rectangle, each axis on its own
// (`nearest`: by 0 outside). So inside its rectangle a picture never turns translucent, a subject cut off by the border
// is not smeared, and a copied pixel (d = 1/2) and its sampled neighbour meet.
//
// 8 bits, opaque taps (no alpha, or full alpha in every tap and no fading), one sample a pixel:
//   bilinear   values in Q6, f in Q15 (truncated); lerp(a, b, f) = a + ((b - a) f + 2^14 >> 15), first between the
//              rows, then between the columns; result (value + 32) >> 6.
//   bicubic, lanczos3
//              f rounded to 1/1024; weights in Q14 from a table, those of a phase of sum 2^14. First along the rows:
//              each sum is cut off to Q6 (>> 8). Then the sum over rows in Q20, to which a half is added and half of
//              what was cut off on average, 2^19 + 2^13; >> 20, clamped.
// All else: as binary32, colours multiplied by alpha (both as numbers of the picture); columns of taps first:
//   bilinear   f in 23 bits (truncated); a + (b - a) f.
//   bicubic    f in 23 bits; p1 + (p0 - p1) w0 + (p2 - p1) w2 + (p3 - p1) w3, added from the left; w: Bicubic::Weights.
//   lanczos3   f in 32 bits: weights of 1/1024 interpolated linearly; p2 + (p0 - p2) w0 + (p1 - p2) w1 + (p3 - p2) w3 +
//              (p4 - p2) w4 + (p5 - p2) w5, added from the left.
//   Of several samples (footprint.h) the mean: s0 + ((s1 - s0) + (s2 - s0) + ...) (1 / n).
//   Then colour is divided by alpha; alpha is clamped to [0, full] and faded; whole numbers: floor(value + 1/2),
//   clamped. Alpha that rounds to 0 (float: below 2^-20, or not a number) gives all zeros.
// Linear light: the same, colours decoded by the picture's tone curves at first and encoded at the end (light.h).

class LightTables;

//! The picture that is read. Rows are `step` bytes apart.
struct Source {
    const std::uint8_t* data = nullptr;
    std::size_t step = 0;
    int width = 0;
    int height = 0;
    int channels = 1;
    std::size_t channel_bytes = 1;
    bool adds_alpha = false;             //!< whether what is made of it has one channel more: full alpha
    const LightTables* light = nullptr;  //!< for linear light
};

inline constexpr double fixed_one = 4294967296.0;

//! Consecutive pixels of one row and one triangle; 32.32 fixed point.
struct Run {
    std::int64_t u = 0, v = 0, du = 0, dv = 0;
    int count = 0;
};

//! What the runs of a triangle have in common.
struct Steps {
    std::int64_t du = 0, dv = 0;
    std::ptrdiff_t ahead = 0;  //!< what lies so many bytes after the taps is soon read
};

//! A run of a triangle, and where in the output it goes.
struct Span {
    std::int64_t u = 0, v = 0;
    int steps = 0;  //!< index of the triangle's
    int row = 0, first = 0;
    std::int16_t count = 0;
    enum class Kind : std::int16_t { inside, anywhere, border } kind = Kind::inside;  //!< for who paints
};

//! Positions whose taps all lie inside the picture: index of the channel with which the first tap begins, and
//! fractions. Room for `places_padding` more than are used.
struct Places {
    std::uint32_t* first;
    std::uint32_t* fx;
    std::uint32_t* fy;

    Places operator+(int n) const { return {first + n, fx + n, fy + n}; }
};
inline constexpr int places_padding = 8;

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

//! Places spans, one after the other. Their positions were shifted: they are those of the first taps.
using PlaceSpans = void (*)(const Source& source, const Span* spans, int count, const Steps* steps,
                            const Places& places);

//! A filter for what a picture holds: pixels, or premultiplied samples for `StoreMeans`.
struct Sampler {
    std::int64_t shift = 0;     //!< from a position to that of its first tap, along both axes
    int taps = 1;               //!< along an axis
    int bytes_loaded = 0;       //!< of each row, from the first tap on
    std::size_t out_bytes = 0;  //!< a sample
    bool gives_pixels = true;

    PlaceSpans place = nullptr;
    //! Samples at places. May write `places_padding` samples more than asked for.
    void (*sample)(const Source& source, const Places& places, int count, void* out) = nullptr;
    //! Samples a run that may lie anywhere (not shifted). Writes exactly what is asked for.
    void (*sample_anywhere)(const Source& source, const Run& run, void* out) = nullptr;
};

//! Stores means of premultiplied samples as pixels. The first samples of all pixels stand before the second ones.
//! \param fades  of the samples: factors of alpha; or null: all 1.
using StoreMeans = void (*)(const Source& source, const void* samples, const float* fades, int count,
                            int samples_a_pixel, void* out);

//! Reads pixels (x, y), (x + 1, y), ... as premultiplied binary32, as many channels as the picture has.
using ReadPremultiplied = void (*)(const Source& source, int x, int y, int count, float* out);

//! What one format needs.
struct Samplers {
    Sampler single;    //!< for pixels of one sample
    Sampler several;   //!< premultiplied, for pixels of more; not for `nearest`
    StoreMeans store;  //!< of the pictures' pixels
    ReadPremultiplied read;
};

//! Portable ones, by depth.
Samplers portable_samplers_8(const PixelFormat& format, Interpolation interpolation, bool linear);
Samplers portable_samplers_16(const PixelFormat& format, Interpolation interpolation, bool linear);
Samplers portable_samplers_float(const PixelFormat& format, Interpolation interpolation);
Sampler portable_level_sampler(int channels, Interpolation interpolation);

//! Premultiplied samples from a level of a pyramid.
Sampler level_sampler(int channels, Interpolation interpolation, Simd simd);

//! The samplers for a format; the widest ones there are up to `simd`.
Samplers find_samplers(const PixelFormat& format, Interpolation interpolation, bool linear, Simd simd);

PlaceSpans find_placement(Simd simd);

//! For 8-bit pixels with alpha.
struct TranslucentPixels {
    //! Premultiplied samples, as `Sampler::sample` of several.
    void (*blend)(const Source& source, const Places& places, int count, void* samples);
    //! Stores those samples that have translucent taps among sampled pixels.
    void (*replace)(const Source& source, const Places& places, int count, const void* samples, std::uint8_t* out);
};
TranslucentPixels translucent_pixels(int channels, Interpolation interpolation);

//! What a sampler reads.
struct Stored {
    int depth = 0;
    int channels = 1;
    enum class As { encoded, decoded, premultiplied } as = As::encoded;  //!< `decoded`: for linear light
};

//! Puts SIMD code in the place of a sampler's portable code, where there is any.
void accelerate_sse41(const Stored& stored, Interpolation interpolation, Sampler& sampler);
void accelerate_avx2(const Stored& stored, Interpolation interpolation, Sampler& sampler);

}  // namespace puppetwarp::detail
