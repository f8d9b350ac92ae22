#pragma once

#include <puppetwarp/warp/filter_tables.h>
#include <puppetwarp/warp/sampling.h>

#include <cstdint>

#include <immintrin.h>

// Premultiplied samples, two at a time in 256 bits, for files compiled for AVX2. Internal linkage for the reason given
// in lane_vectors.h. Channels that a picture has not hold anything.
namespace puppetwarp::detail {

namespace {

struct Pair {
    __m256 v;

    static Pair of(float first, float second) {
        return {_mm256_blend_ps(_mm256_set1_ps(first), _mm256_set1_ps(second), 0xf0)};
    }
};

inline Pair operator+(Pair a, Pair b) {
    return {_mm256_add_ps(a.v, b.v)};
}
inline Pair operator-(Pair a, Pair b) {
    return {_mm256_sub_ps(a.v, b.v)};
}
inline Pair operator*(Pair a, Pair b) {
    return {_mm256_mul_ps(a.v, b.v)};
}

// How four channels are loaded from two addresses.
template <class T>
struct PairLoad;

template <>
struct PairLoad<std::uint8_t> {
    static Pair load(const std::uint8_t* p, const std::uint8_t* q) {
        int first, second;
        __builtin_memcpy(&first, p, 4);
        __builtin_memcpy(&second, q, 4);
        const __m128i bytes = _mm_insert_epi32(_mm_cvtsi32_si128(first), second, 1);
        return {_mm256_cvtepi32_ps(_mm256_cvtepu8_epi32(bytes))};
    }
};

template <>
struct PairLoad<std::uint16_t> {
    static Pair load(const std::uint8_t* p, const std::uint8_t* q) {
        const __m128i words = _mm_unpacklo_epi64(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(p)),
                                                 _mm_loadl_epi64(reinterpret_cast<const __m128i*>(q)));
        return {_mm256_cvtepi32_ps(_mm256_cvtepu16_epi32(words))};
    }
};

template <>
struct PairLoad<float> {
    static Pair load(const std::uint8_t* p, const std::uint8_t* q) {
        const __m128 first = _mm_loadu_ps(reinterpret_cast<const float*>(p));
        const __m128 second = _mm_loadu_ps(reinterpret_cast<const float*>(q));
        return {_mm256_insertf128_ps(_mm256_castps128_ps256(first), second, 1)};
    }
};

template <class T, int Channels, bool Multiplied>
struct PairTaps {
    static constexpr int channels = Channels;
    static constexpr int bytes_a_channel = sizeof(T);
    const std::uint8_t *first, *second;
    std::size_t step;

    PairTaps(const Source& source, const std::uint32_t* place)
        : first(source.data + sizeof(T) * place[0]), second(source.data + sizeof(T) * place[1]), step(source.step) {}

    Pair operator()(int row, int column) const {
        const std::size_t offset =
            static_cast<std::size_t>(row) * step + sizeof(T) * static_cast<std::size_t>(Channels * column);
        const Pair value = PairLoad<T>::load(first + offset, second + offset);
        if (Channels % 2 == 1 || Multiplied) return value;
        constexpr int alpha = Channels == 2 ? 0x55 : 0xff, alpha_bit = Channels == 2 ? 0x22 : 0x88;
        const __m256 factor = _mm256_blend_ps(_mm256_permute_ps(value.v, alpha), _mm256_set1_ps(1), alpha_bit);
        return value * Pair{factor};
    }
};

inline __m256 leading_bits_of_eight(const std::uint32_t* fractions) {
    const __m256i bits = _mm256_srli_epi32(_mm256_loadu_si256(reinterpret_cast<const __m256i*>(fractions)), 9);
    return _mm256_mul_ps(_mm256_cvtepi32_ps(bits), _mm256_set1_ps(0x1p-23F));
}

// Filters hold the weights of eight samples along one axis, and blend the taps of samples i and i + 1.
struct PairBilinear {
    static constexpr int taps = 2;
    float f[8];

    explicit PairBilinear(const std::uint32_t* fractions) { _mm256_storeu_ps(f, leading_bits_of_eight(fractions)); }

    template <class Tap>
    Pair operator()(int i, const Tap& tap) const {
        const Pair a = tap(0);
        return a + (tap(1) - a) * Pair::of(f[i], f[i + 1]);
    }
};

struct PairBicubic {
    static constexpr int taps = 4;
    float w0[8], w2[8], w3[8];

    explicit PairBicubic(const std::uint32_t* fractions) {
        const Pair f{leading_bits_of_eight(fractions)};
        const auto number = [](float x) { return Pair{_mm256_set1_ps(x)}; };
        _mm256_storeu_ps(w0, (((number(-0.5F) * f + number(1)) * f - number(0.5F)) * f).v);
        _mm256_storeu_ps(w2, (((number(-1.5F) * f + number(2)) * f + number(0.5F)) * f).v);
        _mm256_storeu_ps(w3, ((number(0.5F) * f - number(0.5F)) * f * f).v);
    }

    template <class Tap>
    Pair operator()(int i, const Tap& tap) const {
        const Pair p0 = tap(0), p1 = tap(1), p2 = tap(2), p3 = tap(3);
        return p1 + (p0 - p1) * Pair::of(w0[i], w0[i + 1]) + (p2 - p1) * Pair::of(w2[i], w2[i + 1]) +
               (p3 - p1) * Pair::of(w3[i], w3[i + 1]);
    }
};

struct PairLanczos {
    static constexpr int taps = 6;
    float w[8][8];

    explicit PairLanczos(const std::uint32_t* fractions) {
        for (int i = 0; i < 8; ++i) {
            const float* before = lanczos_weights() + 8 * (fractions[i] >> 22);
            const __m256 t = _mm256_set1_ps(static_cast<float>(static_cast<int>(fractions[i] & 0x3fffff)) * 0x1p-22F);
            const __m256 low = _mm256_loadu_ps(before), high = _mm256_loadu_ps(before + 8);
            _mm256_storeu_ps(w[i], _mm256_add_ps(low, _mm256_mul_ps(_mm256_sub_ps(high, low), t)));
        }
    }

    template <class Tap>
    Pair operator()(int i, const Tap& tap) const {
        const Pair middle = tap(2);
        const auto term = [&](int k) { return (tap(k) - middle) * Pair::of(w[i][k], w[i + 1][k]); };
        return middle + term(0) + term(1) + term(3) + term(4) + term(5);
    }
};

template <class Taps, class Filter>
void blend_pairs(const Source& source, const Places& places, int count, void* out) {
    auto* sample = static_cast<float*>(out);
    for (int done = 0; done < count; done += 8) {
        const Places some = places + done;
        const Filter wx(some.fx), wy(some.fy);
        for (int i = 0; i < 8; i += 2, sample += 8) {
            const Taps taps(source, some.first + i);
            Pair columns[Filter::taps];
            for (int k = 0; k < Filter::taps; ++k) {
                columns[k] = wy(i, [&](int row) { return taps(row, k); });
            }
            _mm256_storeu_ps(sample, wx(i, [&](int k) { return columns[k]; }).v);
        }
    }
}

template <class Taps, class Filter>
void use_pairs(Sampler& sampler) {
    sampler.sample = blend_pairs<Taps, Filter>;
    sampler.bytes_loaded = ((Filter::taps - 1) * Taps::channels + 4) * Taps::bytes_a_channel;
}

template <class Taps>
void accelerate_filter_of_pairs(Interpolation interpolation, Sampler& sampler) {
    switch (interpolation) {
        case Interpolation::nearest: break;
        case Interpolation::bilinear: use_pairs<Taps, PairBilinear>(sampler); break;
        case Interpolation::bicubic: use_pairs<Taps, PairBicubic>(sampler); break;
        case Interpolation::lanczos3: use_pairs<Taps, PairLanczos>(sampler); break;
    }
}

template <class T, bool Multiplied>
void accelerate_pairs(int channels, Interpolation interpolation, Sampler& sampler) {
    switch (channels) {
        case 1: accelerate_filter_of_pairs<PairTaps<T, 1, Multiplied>>(interpolation, sampler); break;
        case 2: accelerate_filter_of_pairs<PairTaps<T, 2, Multiplied>>(interpolation, sampler); break;
        case 3: accelerate_filter_of_pairs<PairTaps<T, 3, Multiplied>>(interpolation, sampler); break;
        default: accelerate_filter_of_pairs<PairTaps<T, 4, Multiplied>>(interpolation, sampler); break;
    }
}

}  // namespace

}  // namespace puppetwarp::detail
