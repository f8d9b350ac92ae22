#pragma once

#include <puppetwarp/warp/simd_samplers.h>

#include <immintrin.h>

// 8-bit bilinear sampling in 256-bit SIMD, for files compiled for AVX2. Internal linkage for the reason given in
// simd_samplers.h.
namespace puppetwarp::detail {

namespace {

// Four consecutive pixels in 64-bit lanes. All shuffles stay within 128-bit halves: pixels 0 and 1 in the lower one.
struct FourWide {
    __m256i u, v;

    FourWide(__m256i some_u, __m256i some_v) : u(some_u), v(some_v) {}
    FourWide(const Run& run, __m256i lane) : u(along(run.u, run.du, lane)), v(along(run.v, run.dv, lane)) {}

    // The low 64 bits of a product, from 32-bit ones: `lane` is 0 to 3.
    static __m256i along(std::int64_t start, std::int64_t step, __m256i lane) {
        const __m256i steps = _mm256_set1_epi64x(step);
        const __m256i low = _mm256_mul_epu32(steps, lane), high = _mm256_mul_epu32(_mm256_srli_epi64(steps, 32), lane);
        return _mm256_add_epi64(_mm256_set1_epi64x(start), _mm256_add_epi64(low, _mm256_slli_epi64(high, 32)));
    }

    static __m256i fraction_q15(__m256i position) { return _mm256_srli_epi32(position, 17); }
};

template <int C>
struct WideBilinear {
    static constexpr int before = 0;
    static constexpr int taps = 2;
    static constexpr int bytes_loaded = 8;

    // Left and right taps of two pixels, 8 bytes in each 128-bit half: [0] pixels 0 and 2, [1] pixels 1 and 3.
    struct Corners {
        __m256i upper[2], lower[2];
    };

    static __m256i pair(const std::uint8_t* p, const std::uint8_t* q) {
        std::int64_t bytes;
        __builtin_memcpy(&bytes, q, 8);
        const __m128i first = _mm_loadl_epi64(reinterpret_cast<const __m128i*>(p));
        return _mm256_blend_epi32(_mm256_castsi128_si256(first), _mm256_set1_epi64x(bytes), 0xf0);
    }

    static Corners load(const SourceView& source, const FourWide& at) {
        const __m256i x = _mm256_srli_epi64(at.u, 32), y = _mm256_srli_epi64(at.v, 32);
        const __m256i rows = _mm256_mul_epu32(y, _mm256_set1_epi64x(static_cast<std::int64_t>(source.step)));
        const __m256i columns = C == 4 ? _mm256_slli_epi64(x, 2) : _mm256_add_epi64(x, _mm256_add_epi64(x, x));
        const __m256i offsets = _mm256_add_epi64(rows, columns);
        const __m128i low = _mm256_castsi256_si128(offsets), high = _mm256_extracti128_si256(offsets, 1);
        const std::uint8_t* p0 = source.data + _mm_cvtsi128_si64(low);
        const std::uint8_t* p1 = source.data + _mm_extract_epi64(low, 1);
        const std::uint8_t* p2 = source.data + _mm_cvtsi128_si64(high);
        const std::uint8_t* p3 = source.data + _mm_extract_epi64(high, 1);
        const std::size_t step = source.step;
        return {{pair(p0, p2), pair(p1, p3)}, {pair(p0 + step, p2 + step), pair(p1 + step, p3 + step)}};
    }

    static bool opaque(const Corners& c) {
        if (C == 3) return true;
        const __m256i all =
            _mm256_and_si256(_mm256_and_si256(c.upper[0], c.upper[1]), _mm256_and_si256(c.lower[0], c.lower[1]));
        const auto full = static_cast<unsigned>(_mm256_movemask_epi8(_mm256_cmpeq_epi8(all, _mm256_set1_epi8(-1))));
        return (full & 0x00880088U) == 0x00880088U;
    }

    // a + (b - a) f, as sampling.h has it.
    static __m256i lerp(__m256i a, __m256i b, __m256i f) {
        return _mm256_add_epi16(a, _mm256_mulhrs_epi16(_mm256_sub_epi16(b, a), f));
    }

    // Channels in Q7, 16 bits each: the left tap's four, then the right one's.
    static __m256i q7(__m256i bytes) {
        const __m128i order = C == 4 ? _mm_setr_epi8(0, -1, 1, -1, 2, -1, 3, -1, 4, -1, 5, -1, 6, -1, 7, -1)
                                     : _mm_setr_epi8(0, -1, 1, -1, 2, -1, -1, -1, 3, -1, 4, -1, 5, -1, -1, -1);
        return _mm256_slli_epi16(_mm256_shuffle_epi8(bytes, _mm256_broadcastsi128_si256(order)), 7);
    }

    // Four pixels, rounded, 16 bits a channel.
    static __m256i blend(const Corners& c, const FourWide& at) {
        const __m256i fx = FourWide::fraction_q15(at.u), fy = FourWide::fraction_q15(at.v);
        const __m256i even = _mm256_set1_epi16(0x0100), odd = _mm256_set1_epi16(0x0908);
        const __m256i p = lerp(q7(c.upper[0]), q7(c.lower[0]), _mm256_shuffle_epi8(fy, even));
        const __m256i q = lerp(q7(c.upper[1]), q7(c.lower[1]), _mm256_shuffle_epi8(fy, odd));
        const __m256i both = _mm256_broadcastsi128_si256(_mm_setr_epi8(0, 1, 0, 1, 0, 1, 0, 1, 8, 9, 8, 9, 8, 9, 8, 9));
        const __m256i value =
            lerp(_mm256_unpacklo_epi64(p, q), _mm256_unpackhi_epi64(p, q), _mm256_shuffle_epi8(fx, both));
        return _mm256_srli_epi16(_mm256_add_epi16(value, _mm256_set1_epi16(64)), 7);
    }

    // 4 bytes a pixel.
    static __m128i packed(__m256i pixels) {
        return _mm_packus_epi16(_mm256_castsi256_si128(pixels), _mm256_extracti128_si256(pixels, 1));
    }
};

// Pixels whose taps all lie inside.
template <int C, bool AddsAlpha>
struct WideBilinearInside {
    static constexpr int out_channels = C + AddsAlpha;
    const SourceView& source;
    const Run& run;
    std::uint8_t* out;

    // Pixels first .. first + count - 1.
    [[gnu::always_inline]] void group(const FourWide& at, int first, int count) const {
        const auto corners = WideBilinear<C>::load(source, at);
        if (WideBilinear<C>::opaque(corners)) {
            const __m128i pixels = WideBilinear<C>::packed(WideBilinear<C>::blend(corners, at));
            store_pixels<C, AddsAlpha>(pixels, out + out_channels * first, count);
        } else {
            scalar_sampler<C, AddsAlpha>(Interpolation::bilinear)(source, part(run, first, first + count),
                                                                  out + out_channels * first);
        }
    }

    [[gnu::always_inline]] void all() const {
        // Lanes past the end of a short run repeat its last pixel: their loads are safe, their results dropped.
        const __m256i last = _mm256_set1_epi32(run.count - 1);
        const FourWide lanes(run, _mm256_min_epi32(_mm256_setr_epi64x(0, 1, 2, 3), last));
        if (run.count < 4) {
            group(lanes, 0, run.count);
            return;
        }
        // The last four overlap those before: the same positions, the same bytes. No code of its own for what is left
        // over, as most runs are short and their lengths cannot be foretold.
        for (int i = 0; i < run.count; i += 4) {
            const int first = i < run.count - 4 ? i : run.count - 4;
            group({_mm256_add_epi64(lanes.u, _mm256_set1_epi64x(first * run.du)),
                   _mm256_add_epi64(lanes.v, _mm256_set1_epi64x(first * run.dv))},
                  first, 4);
        }
    }
};

template <int C, bool AddsAlpha>
void sample_bilinear_wide(const SourceView& source, const Run& run, void* out) {
    sample_in_parts<C, AddsAlpha, WideBilinear<C>>(Interpolation::bilinear, source, run,
                                                   static_cast<std::uint8_t*>(out),
                                                   [&](const Run& inside, std::uint8_t* to) {
                                                       WideBilinearInside<C, AddsAlpha>{source, inside, to}.all();
                                                   });
}

RunSampler wide_bilinear_sampler(const PixelFormat& format) {
    if (format.depth != CV_8U || format.channels < 3) return nullptr;
    if (format.channels == 4) return sample_bilinear_wide<4, false>;
    return format.adds_alpha ? sample_bilinear_wide<3, true> : sample_bilinear_wide<3, false>;
}

}  // namespace

}  // namespace puppetwarp::detail
