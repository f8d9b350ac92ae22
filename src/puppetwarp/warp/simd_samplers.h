#pragma once

#include <puppetwarp/warp/simd_run.h>

#include <smmintrin.h>

// 8-bit samplers in 128-bit SIMD, for files that are compiled for a processor which has at least SSE 4.1. Everything
// has internal linkage and no inline function of a library is called, so that no such code can end up where files
// compiled for every processor call the same function.
namespace puppetwarp::detail {

namespace {

// Positions of four pixels at a time.
struct FourPositions {
    __m128i u01, u23, v01, v23, du, dv;  // 64-bit lanes

    FourPositions(const Run& run, int last_lane) {
        // Lanes past the end repeat the first pixel: their loads are safe, their results dropped.
        const auto at = [&](std::int64_t start, std::int64_t step, int lane) {
            return start + (lane <= last_lane ? lane : 0) * step;
        };
        u01 = _mm_set_epi64x(at(run.u, run.du, 1), run.u);
        u23 = _mm_set_epi64x(at(run.u, run.du, 3), at(run.u, run.du, 2));
        v01 = _mm_set_epi64x(at(run.v, run.dv, 1), run.v);
        v23 = _mm_set_epi64x(at(run.v, run.dv, 3), at(run.v, run.dv, 2));
        du = _mm_set1_epi64x(4 * run.du);
        dv = _mm_set1_epi64x(4 * run.dv);
    }

    // To `pixels` pixels before.
    void go_back(const Run& run, int pixels) {
        const __m128i back_u = _mm_set1_epi64x(pixels * run.du), back_v = _mm_set1_epi64x(pixels * run.dv);
        u01 = _mm_sub_epi64(u01, back_u);
        u23 = _mm_sub_epi64(u23, back_u);
        v01 = _mm_sub_epi64(v01, back_v);
        v23 = _mm_sub_epi64(v23, back_v);
    }

    void advance() {
        u01 = _mm_add_epi64(u01, du);
        u23 = _mm_add_epi64(u23, du);
        v01 = _mm_add_epi64(v01, dv);
        v23 = _mm_add_epi64(v23, dv);
    }

    static __m128i high_words(__m128i a, __m128i b) {
        return _mm_castps_si128(_mm_shuffle_ps(_mm_castsi128_ps(a), _mm_castsi128_ps(b), _MM_SHUFFLE(3, 1, 3, 1)));
    }
    static __m128i low_words(__m128i a, __m128i b) {
        return _mm_castps_si128(_mm_shuffle_ps(_mm_castsi128_ps(a), _mm_castsi128_ps(b), _MM_SHUFFLE(2, 0, 2, 0)));
    }
    __m128i x() const { return high_words(u01, u23); }
    __m128i y() const { return high_words(v01, v23); }
    __m128i fx() const { return low_words(u01, u23); }
    __m128i fy() const { return low_words(v01, v23); }
};

struct Offsets {
    std::int32_t of[4];

    template <int C>
    static Offsets at(const FourPositions& positions, __m128i step) {
        const __m128i x = positions.x();
        const __m128i columns = C == 4 ? _mm_slli_epi32(x, 2) : _mm_add_epi32(x, _mm_add_epi32(x, x));
        const __m128i offsets = _mm_add_epi32(_mm_mullo_epi32(positions.y(), step), columns);
        return {{_mm_cvtsi128_si32(offsets), _mm_extract_epi32(offsets, 1), _mm_extract_epi32(offsets, 2),
                 _mm_extract_epi32(offsets, 3)}};
    }
};

// Four pixels, 4 bytes each, of which the first `count` are stored.
template <int C, bool AddsAlpha>
void store_pixels(__m128i pixels, std::uint8_t* out, int count) {
    constexpr int out_channels = C + AddsAlpha;
    if (AddsAlpha) pixels = _mm_or_si128(pixels, _mm_set1_epi32(static_cast<int>(0xff000000U)));
    if (out_channels == 3) {
        pixels = _mm_shuffle_epi8(pixels, _mm_setr_epi8(0, 1, 2, 4, 5, 6, 8, 9, 10, 12, 13, 14, -1, -1, -1, -1));
    }
    if (count == 4 && out_channels == 4) {
        _mm_storeu_si128(reinterpret_cast<__m128i*>(out), pixels);
    } else if (count == 4) {
        _mm_storel_epi64(reinterpret_cast<__m128i*>(out), pixels);
        const int tail = _mm_extract_epi32(pixels, 2);
        __builtin_memcpy(out + 8, &tail, 4);
    } else if (count == 1) {
        const int pixel = _mm_cvtsi128_si32(pixels);
        __builtin_memcpy(out, &pixel, out_channels);
    } else {
        // Two pixels, and a third one.
        const std::int64_t two = _mm_cvtsi128_si64(pixels);
        const std::int64_t third = _mm_cvtsi128_si64(_mm_srli_si128(pixels, 2 * out_channels));
        __builtin_memcpy(out, &two, 2 * out_channels);
        if (count == 3) __builtin_memcpy(out + 2 * out_channels, &third, out_channels);
    }
}

// a + (b - a) f, as sampling.h has it.
__m128i lerp(__m128i a, __m128i b, __m128i f) {
    return _mm_add_epi16(a, _mm_mulhrs_epi16(_mm_sub_epi16(b, a), f));
}

__m128i load8(const std::uint8_t* p) {
    return _mm_loadl_epi64(reinterpret_cast<const __m128i*>(p));
}

// Two neighbouring pixels, each in four 16-bit lanes.
template <int C>
__m128i two_pixels(__m128i bytes) {
    if (C == 4) return _mm_cvtepu8_epi16(bytes);
    return _mm_shuffle_epi8(bytes, _mm_setr_epi8(0, -1, 1, -1, 2, -1, -1, -1, 3, -1, 4, -1, 5, -1, -1, -1));
}

template <int C>
struct BilinearKernel {
    static constexpr int before = 0;
    static constexpr int taps = 2;
    static constexpr int bytes_loaded = 8;
    const std::uint8_t* data;
    std::size_t step;

    struct Corners {
        __m128i upper[4], lower[4];
    };

    Corners load(const Offsets& offsets) const {
        Corners corners;
        for (int i = 0; i < 4; ++i) {
            const std::uint8_t* p = data + offsets.of[i];
            corners.upper[i] = load8(p);
            corners.lower[i] = load8(p + step);
        }
        return corners;
    }

    static __m128i all_taps(const Corners& c) {
        const __m128i a = _mm_and_si128(_mm_and_si128(c.upper[0], c.lower[0]), _mm_and_si128(c.upper[1], c.lower[1]));
        const __m128i b = _mm_and_si128(_mm_and_si128(c.upper[2], c.lower[2]), _mm_and_si128(c.upper[3], c.lower[3]));
        return _mm_and_si128(a, b);
    }

    static bool opaque(const Corners& c) {
        if (C == 3) return true;
        const __m128i full = _mm_cmpeq_epi8(all_taps(c), _mm_set1_epi8(-1));
        return (_mm_movemask_epi8(full) & 0x88) == 0x88;
    }

    // Four pixels, rounded, 4 bytes each.
    static __m128i blend(const Corners& c, const FourPositions& positions) {
        const __m128i fx = _mm_srli_epi32(positions.fx(), 17), fy = _mm_srli_epi32(positions.fy(), 17);
        const __m128i row0 = between_rows(c, 0, fy, _mm_set1_epi16(0x0100));
        const __m128i row1 = between_rows(c, 1, fy, _mm_set1_epi16(0x0504));
        const __m128i row2 = between_rows(c, 2, fy, _mm_set1_epi16(0x0908));
        const __m128i row3 = between_rows(c, 3, fy, _mm_set1_epi16(0x0d0c));
        const __m128i first = _mm_setr_epi8(0, 1, 0, 1, 0, 1, 0, 1, 4, 5, 4, 5, 4, 5, 4, 5);
        const __m128i second = _mm_setr_epi8(8, 9, 8, 9, 8, 9, 8, 9, 12, 13, 12, 13, 12, 13, 12, 13);
        return _mm_packus_epi16(between_columns(row0, row1, _mm_shuffle_epi8(fx, first)),
                                between_columns(row2, row3, _mm_shuffle_epi8(fx, second)));
    }

    static __m128i between_rows(const Corners& c, int i, __m128i fy, __m128i lane) {
        const __m128i upper = _mm_slli_epi16(two_pixels<C>(c.upper[i]), 7);
        const __m128i lower = _mm_slli_epi16(two_pixels<C>(c.lower[i]), 7);
        return lerp(upper, lower, _mm_shuffle_epi8(fy, lane));
    }

    static __m128i between_columns(__m128i p, __m128i q, __m128i fx) {
        const __m128i value = lerp(_mm_unpacklo_epi64(p, q), _mm_unpackhi_epi64(p, q), fx);
        return _mm_srli_epi16(_mm_add_epi16(value, _mm_set1_epi16(64)), 7);
    }
};

template <int C, bool AddsAlpha>
struct BilinearInside {
    static constexpr int out_channels = C + AddsAlpha;
    const SourceView& source;
    const Run& run;
    std::uint8_t* out;

    // Pixels first .. first + count - 1.
    void group(const FourPositions& positions, int first, int count) const {
        const BilinearKernel<C> kernel{source.data, source.step};
        const auto corners = kernel.load(Offsets::at<C>(positions, _mm_set1_epi32(static_cast<int>(source.step))));
        if (kernel.opaque(corners)) {
            store_pixels<C, AddsAlpha>(kernel.blend(corners, positions), out + out_channels * first, count);
        } else {
            scalar_sampler<C, AddsAlpha>(Interpolation::bilinear)(source, part(run, first, first + count),
                                                                  out + out_channels * first);
        }
    }

    void all() const {
        FourPositions positions(run, run.count - 1);
        if (run.count < 4) {
            group(positions, 0, run.count);
            return;
        }
        int i = 0;
        for (; i + 4 <= run.count; i += 4, positions.advance()) group(positions, i, 4);
        if (i == run.count) return;
        // The last four once more, overlapping: the same positions, the same bytes.
        positions.go_back(run, i + 4 - run.count);
        group(positions, run.count - 4, 4);
    }
};

template <int C, bool AddsAlpha>
void sample_bilinear(const SourceView& source, const Run& run, void* out) {
    sample_in_parts<C, AddsAlpha, BilinearKernel<C>>(Interpolation::bilinear, source, run,
                                                     static_cast<std::uint8_t*>(out),
                                                     [&](const Run& inside, std::uint8_t* to) {
                                                         BilinearInside<C, AddsAlpha>{source, inside, to}.all();
                                                     });
}

// Four neighbouring pixels of a row in bytes, 4 each.
template <int C>
__m128i four_pixels(const std::uint8_t* p) {
    const __m128i bytes = _mm_loadu_si128(reinterpret_cast<const __m128i*>(p));
    if (C == 4) return bytes;
    return _mm_shuffle_epi8(bytes, _mm_setr_epi8(0, 1, 2, -1, 3, 4, 5, -1, 6, 7, 8, -1, 9, 10, 11, -1));
}

template <int C>
struct BicubicKernel {
    static constexpr int before = 1;
    static constexpr int taps = 4;
    static constexpr int bytes_loaded = 16;

    struct Rows {
        __m128i of[4];
    };

    static Rows load(const std::uint8_t* p, std::size_t step) {
        return {
            {four_pixels<C>(p), four_pixels<C>(p + step), four_pixels<C>(p + 2 * step), four_pixels<C>(p + 3 * step)}};
    }

    static bool opaque(const Rows& rows) {
        if (C == 3) return true;
        const __m128i all = _mm_and_si128(_mm_and_si128(rows.of[0], rows.of[1]), _mm_and_si128(rows.of[2], rows.of[3]));
        return (_mm_movemask_epi8(_mm_cmpeq_epi8(all, _mm_set1_epi8(-1))) & 0x8888) == 0x8888;
    }

    // Sums over the rows for two of the four columns, Q6 in 16 bits: `upper` and `lower` are interleaved bytes of rows
    // 0 and 1 and of rows 2 and 3.
    static __m128i column_sums(__m128i upper, __m128i lower, __m128i w01, __m128i w23) {
        const __m128i zero = _mm_setzero_si128(), half = _mm_set1_epi32(128);
        const __m128i first = _mm_add_epi32(_mm_madd_epi16(_mm_unpacklo_epi8(upper, zero), w01),
                                            _mm_madd_epi16(_mm_unpacklo_epi8(lower, zero), w23));
        const __m128i second = _mm_add_epi32(_mm_madd_epi16(_mm_unpackhi_epi8(upper, zero), w01),
                                             _mm_madd_epi16(_mm_unpackhi_epi8(lower, zero), w23));
        return _mm_packs_epi32(_mm_srai_epi32(_mm_add_epi32(first, half), 8),
                               _mm_srai_epi32(_mm_add_epi32(second, half), 8));
    }

    // One pixel, its channels in 32-bit lanes, before clamping.
    static __m128i blend(const Rows& rows, const std::int16_t* wx, const std::int16_t* wy) {
        const __m128i weights_x = _mm_loadl_epi64(reinterpret_cast<const __m128i*>(wx));
        const __m128i weights_y = _mm_loadl_epi64(reinterpret_cast<const __m128i*>(wy));
        const __m128i y01 = _mm_shuffle_epi32(weights_y, 0x00), y23 = _mm_shuffle_epi32(weights_y, 0x55);
        const __m128i columns01 =
            column_sums(_mm_unpacklo_epi8(rows.of[0], rows.of[1]), _mm_unpacklo_epi8(rows.of[2], rows.of[3]), y01, y23);
        const __m128i columns23 =
            column_sums(_mm_unpackhi_epi8(rows.of[0], rows.of[1]), _mm_unpackhi_epi8(rows.of[2], rows.of[3]), y01, y23);
        const __m128i pairs01 = _mm_unpacklo_epi16(columns01, _mm_unpackhi_epi64(columns01, columns01));
        const __m128i pairs23 = _mm_unpacklo_epi16(columns23, _mm_unpackhi_epi64(columns23, columns23));
        const __m128i sum = _mm_add_epi32(_mm_madd_epi16(pairs01, _mm_shuffle_epi32(weights_x, 0x00)),
                                          _mm_madd_epi16(pairs23, _mm_shuffle_epi32(weights_x, 0x55)));
        return _mm_srai_epi32(_mm_add_epi32(sum, _mm_set1_epi32(1 << 19)), 20);
    }
};

template <int C, bool AddsAlpha>
void bicubic_inside(const SourceView& source, const Run& run, std::uint8_t* out) {
    constexpr int out_channels = C + AddsAlpha;
    const std::int16_t* table = cubic_weight_table();
    const auto weights = [&](std::int64_t u) { return table + 4 * (((static_cast<std::uint32_t>(u) >> 21) + 1) >> 1); };
    std::int64_t u = run.u, v = run.v;
    for (int i = 0; i < run.count; ++i, u += run.du, v += run.dv) {
        const std::uint8_t* p =
            source.data + ((v >> 32) - 1) * static_cast<std::int64_t>(source.step) + C * ((u >> 32) - 1);
        const auto rows = BicubicKernel<C>::load(p, source.step);
        if (!BicubicKernel<C>::opaque(rows)) {
            scalar_sampler<C, AddsAlpha>(Interpolation::bicubic)(source, part(run, i, i + 1), out + out_channels * i);
            continue;
        }
        __m128i pixel = BicubicKernel<C>::blend(rows, weights(u), weights(v));
        pixel = _mm_packs_epi32(pixel, pixel);
        store_pixels<C, AddsAlpha>(_mm_packus_epi16(pixel, pixel), out + out_channels * i, 1);
    }
}

template <int C, bool AddsAlpha>
void sample_bicubic(const SourceView& source, const Run& run, void* out) {
    sample_in_parts<C, AddsAlpha, BicubicKernel<C>>(
        Interpolation::bicubic, source, run, static_cast<std::uint8_t*>(out),
        [&](const Run& inside, std::uint8_t* to) { bicubic_inside<C, AddsAlpha>(source, inside, to); });
}

template <int C, bool AddsAlpha>
RunSampler of_filter(Interpolation interpolation) {
    switch (interpolation) {
        case Interpolation::bilinear: return sample_bilinear<C, AddsAlpha>;
        case Interpolation::bicubic: return sample_bicubic<C, AddsAlpha>;
        default: return nullptr;
    }
}

RunSampler simd_sampler(const PixelFormat& format, Interpolation interpolation) {
    if (format.depth != CV_8U || format.channels < 3) return nullptr;
    if (format.channels == 4) return of_filter<4, false>(interpolation);
    return format.adds_alpha ? of_filter<3, true>(interpolation) : of_filter<3, false>(interpolation);
}

}  // namespace

}  // namespace puppetwarp::detail
