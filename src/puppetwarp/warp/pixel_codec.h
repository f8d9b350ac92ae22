#pragma once

#include <puppetwarp/warp/light.h>
#include <puppetwarp/warp/sampling.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <type_traits>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

// Pixels as they are stored, and as the numbers that filters blend.
namespace puppetwarp::detail {

//! Four binary32 numbers: the channels of a pixel. Element-wise, so the same bits whatever the compiler makes of it.
using Four = float __attribute__((vector_size(16)));

//! The channels of a pixel of whole numbers, the first in the lowest bits.
template <class T, int C>
std::uint64_t channel_bits(const T* p) {
    if constexpr (C == 3) {
        return channel_bits<T, 2>(p) | std::uint64_t{p[2]} << (2 * std::numeric_limits<T>::digits);
    } else {
        std::uint64_t bits = 0;
        std::memcpy(&bits, p, sizeof(T) * C);
        return bits;
    }
}

template <class T, int C>
Four as_four(const T* p) {
#if defined(__SSE2__)
    if constexpr (!std::is_floating_point_v<T>) {
        const __m128i zero = _mm_setzero_si128();
        __m128i value = _mm_cvtsi64_si128(static_cast<std::int64_t>(channel_bits<T, C>(p)));
        if constexpr (sizeof(T) == 1) value = _mm_unpacklo_epi8(value, zero);
        return Four(_mm_cvtepi32_ps(_mm_unpacklo_epi16(value, zero)));
    }
#endif
    Four value = {};
    for (int c = 0; c < C; ++c) value[c] = static_cast<float>(p[c]);
    return value;
}

//! A number as it is stored: whole numbers rounded and clamped.
template <class T>
T rounded(float value) {
    if constexpr (std::is_floating_point_v<T>) {
        return value;
    } else {
        constexpr auto full = static_cast<float>(std::numeric_limits<T>::max());
        return static_cast<T>(static_cast<int>(std::clamp(value + 0.5F, 0.0F, full)));
    }
}

//! Stores channels: whole numbers rounded and clamped.
template <class T, int C>
void store_rounded(Four value, T* out) {
#if defined(__SSE2__)
    if constexpr (!std::is_floating_point_v<T>) {
        const auto full = static_cast<float>(std::numeric_limits<T>::max());
        const __m128 raised = _mm_max_ps(_mm_add_ps(__m128(value), _mm_set1_ps(0.5F)), _mm_setzero_ps());
        __m128i whole = _mm_cvttps_epi32(_mm_min_ps(raised, _mm_set1_ps(full)));
        if constexpr (sizeof(T) == 1) {
            whole = _mm_packs_epi32(whole, whole);
            whole = _mm_packus_epi16(whole, whole);
        } else {
            // Without sign they have 16 bits, which the instruction does not keep.
            whole = _mm_sub_epi32(whole, _mm_set1_epi32(32768));
            whole = _mm_xor_si128(_mm_packs_epi32(whole, whole), _mm_set1_epi16(-32768));
        }
        const std::int64_t bits = _mm_cvtsi128_si64(whole);
        std::memcpy(out, &bits, sizeof(T) * C);
        return;
    }
#endif
    for (int c = 0; c < C; ++c) out[c] = rounded<T>(value[c]);
}

//! Colours multiplied by alpha.
template <int C>
Four times_alpha(Four value) {
    if constexpr (C % 2 == 1) return value;
    const float a = value[C - 1];
    Four factor = {a, a, a, a};
    factor[C - 1] = 1;
    return value * factor;
}

//! Pixels of one depth and number of channels, blended as they are stored.
template <class T, int C>
struct Encoded {
    using Channel = T;
    static constexpr int channels = C;
    static constexpr bool has_alpha = C % 2 == 0;
    static constexpr T full_value = std::is_floating_point_v<T> ? T{1} : std::numeric_limits<T>::max();
    static constexpr auto full = static_cast<float>(full_value);

    explicit Encoded(const Source&) {}

    Four straight(const T* p) const { return as_four<T, C>(p); }
    Four premultiplied(const T* p) const { return times_alpha<C>(straight(p)); }
    void store(Four straight, T* out) const { store_rounded<T, C>(straight, out); }
};

//! Whole numbers, blended in linear light.
template <class T, int C>
struct Decoded {
    using Channel = T;
    static constexpr int channels = C;
    static constexpr bool has_alpha = C % 2 == 0;
    static constexpr T full_value = std::numeric_limits<T>::max();
    static constexpr auto full = static_cast<float>(full_value);
    const LightTables& light;
    const float* table[3];

    explicit Decoded(const Source& source) : light(*source.light) {
        for (int c = 0; c < C - has_alpha; ++c) table[c] = light.decode(c);
    }

    Four straight(const T* p) const {
        Four value = {};
        for (int c = 0; c < C - has_alpha; ++c) value[c] = table[c][p[c]];
        if (has_alpha) value[C - 1] = static_cast<float>(p[C - 1]);
        return value;
    }
    Four premultiplied(const T* p) const { return times_alpha<C>(straight(p)); }
    void store(Four straight, T* out) const {
        for (int c = 0; c < C - has_alpha; ++c) out[c] = static_cast<T>(light.encode(c, straight[c]));
        if (has_alpha) out[C - 1] = rounded<T>(straight[C - 1]);
    }
};

//! Levels of a pyramid: numbers that were decoded and multiplied already.
template <int C>
struct Blended {
    using Channel = float;
    static constexpr int channels = C;
    static constexpr bool has_alpha = C % 2 == 0;

    explicit Blended(const Source&) {}

    Four premultiplied(const float* p) const { return as_four<float, C>(p); }
};

//! Stores premultiplied channels as a pixel. \param fade  factor of alpha.
template <class Codec>
void store_pixel(const Codec& codec, Four value, float fade, typename Codec::Channel* out) {
    using T = typename Codec::Channel;
    if constexpr (!Codec::has_alpha) {
        codec.store(value, out);
        return;
    }
    constexpr int alpha = Codec::channels - 1;
    const float a = value[alpha];
    const float shown = std::clamp(a, 0.0F, Codec::full) * fade;
    // Not a number: as nothing.
    if (std::is_floating_point_v<T> ? !(shown >= 0x1p-20F) : shown < 0.5F) {
        std::fill_n(out, Codec::channels, T{});
        return;
    }
    Four straight = value / Four{a, a, a, a};
    straight[alpha] = shown;
    codec.store(straight, out);
}

}  // namespace puppetwarp::detail
