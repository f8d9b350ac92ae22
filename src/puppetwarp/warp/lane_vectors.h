#pragma once

#include <cstdint>

#include <immintrin.h>

// Vectors of one or two 128-bit lanes. What is written for one pixel a lane serves both widths.
//
// Everything here has internal linkage, and code that includes it calls no inline function of a library: it is compiled
// for several instruction sets, and no such code may end up where files compiled for every processor call the same
// function.
namespace puppetwarp::detail {

namespace {

// Bytes as every lane has them.
struct LaneBytes {
    alignas(32) signed char at[32];
};

template <class Byte>
constexpr LaneBytes lane_bytes(const Byte& byte) {
    LaneBytes bytes{};
    for (int i = 0; i < 32; ++i) bytes.at[i] = static_cast<signed char>(byte(i % 16));
    return bytes;
}

#if defined(__SSE4_1__)

struct OneLane {
    static constexpr int lanes = 1;
    __m128i v;

    static OneLane of(const LaneBytes& bytes) { return {_mm_load_si128(reinterpret_cast<const __m128i*>(bytes.at))}; }
    static OneLane words(short value) { return {_mm_set1_epi16(value)}; }
    static OneLane dwords(int value) { return {_mm_set1_epi32(value)}; }
    static OneLane load(const std::uint32_t* p) { return {_mm_loadu_si128(reinterpret_cast<const __m128i*>(p))}; }
    void store(std::uint32_t* p) const { _mm_storeu_si128(reinterpret_cast<__m128i*>(p), v); }
    __m128i lane(int) const { return v; }

    // Of each place 16 bytes.
    static OneLane gather16(const std::uint8_t* data, const std::uint32_t* place) {
        return {_mm_loadu_si128(reinterpret_cast<const __m128i*>(data + place[0]))};
    }
    // Of each place 8 bytes of `upper`, then 8 of `lower`.
    static OneLane gather8(const std::uint8_t* upper, const std::uint8_t* lower, const std::uint32_t* place) {
        return {_mm_unpacklo_epi64(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(upper + place[0])),
                                   _mm_loadl_epi64(reinterpret_cast<const __m128i*>(lower + place[0])))};
    }
    // Of each place two words, repeated.
    static OneLane gather_pair(const std::int16_t* table, const std::uint32_t* place) {
        int pair;
        __builtin_memcpy(&pair, table + place[0], 4);
        return {_mm_set1_epi32(pair)};
    }
};

inline OneLane operator&(OneLane a, OneLane b) {
    return {_mm_and_si128(a.v, b.v)};
}
inline OneLane operator|(OneLane a, OneLane b) {
    return {_mm_or_si128(a.v, b.v)};
}
inline OneLane add16(OneLane a, OneLane b) {
    return {_mm_add_epi16(a.v, b.v)};
}
inline OneLane sub16(OneLane a, OneLane b) {
    return {_mm_sub_epi16(a.v, b.v)};
}
inline OneLane add32(OneLane a, OneLane b) {
    return {_mm_add_epi32(a.v, b.v)};
}
inline OneLane times_q15(OneLane a, OneLane f) {
    return {_mm_mulhrs_epi16(a.v, f.v)};
}
inline OneLane sums_of_word_pairs(OneLane a, OneLane w) {
    return {_mm_madd_epi16(a.v, w.v)};
}
inline OneLane sums_of_byte_pairs(OneLane a, OneLane w) {
    return {_mm_maddubs_epi16(a.v, w.v)};
}
inline OneLane shuffled(OneLane a, OneLane order) {
    return {_mm_shuffle_epi8(a.v, order.v)};
}
inline OneLane low_halves(OneLane a, OneLane b) {
    return {_mm_unpacklo_epi64(a.v, b.v)};
}
inline OneLane high_halves(OneLane a, OneLane b) {
    return {_mm_unpackhi_epi64(a.v, b.v)};
}
inline OneLane words_of(OneLane a, OneLane b) {
    return {_mm_packs_epi32(a.v, b.v)};
}
inline OneLane bytes_of(OneLane a, OneLane b) {
    return {_mm_packus_epi16(a.v, b.v)};
}
inline OneLane with_odd_words(OneLane even, OneLane odd) {
    return {_mm_blend_epi16(even.v, odd.v, 0xaa)};
}
template <int N>
OneLane right16(OneLane a) {
    return {_mm_srli_epi16(a.v, N)};
}
template <int N>
OneLane right32(OneLane a) {
    return {_mm_srli_epi32(a.v, N)};
}
template <int N>
OneLane signed_right32(OneLane a) {
    return {_mm_srai_epi32(a.v, N)};
}
template <int N>
OneLane left32(OneLane a) {
    return {_mm_slli_epi32(a.v, N)};
}
inline bool all_ones(OneLane a) {
    return _mm_test_all_ones(a.v) != 0;
}

#endif

#if defined(__AVX2__)

struct TwoLanes {
    static constexpr int lanes = 2;
    __m256i v;

    static TwoLanes of(const LaneBytes& bytes) {
        return {_mm256_load_si256(reinterpret_cast<const __m256i*>(bytes.at))};
    }
    static TwoLanes words(short value) { return {_mm256_set1_epi16(value)}; }
    static TwoLanes dwords(int value) { return {_mm256_set1_epi32(value)}; }
    static TwoLanes load(const std::uint32_t* p) { return {_mm256_loadu_si256(reinterpret_cast<const __m256i*>(p))}; }
    void store(std::uint32_t* p) const { _mm256_storeu_si256(reinterpret_cast<__m256i*>(p), v); }
    __m128i lane(int i) const { return i == 0 ? _mm256_castsi256_si128(v) : _mm256_extracti128_si256(v, 1); }

    // The second lane's place is four further on.
    static TwoLanes gather16(const std::uint8_t* data, const std::uint32_t* place) {
        const __m128i first = _mm_loadu_si128(reinterpret_cast<const __m128i*>(data + place[0]));
        const __m128i second = _mm_loadu_si128(reinterpret_cast<const __m128i*>(data + place[4]));
        return {_mm256_inserti128_si256(_mm256_castsi128_si256(first), second, 1)};
    }
    // Broadcasts and blends: they do without the shuffle units.
    static TwoLanes gather8(const std::uint8_t* upper, const std::uint8_t* lower, const std::uint32_t* place) {
        const std::uint32_t p = place[0], q = place[4];
        const __m256i first = _mm256_blend_epi32(everywhere(upper + p), everywhere(lower + p), 0x0c);
        const __m256i second = _mm256_blend_epi32(everywhere(upper + q), everywhere(lower + q), 0xc0);
        return {_mm256_blend_epi32(first, second, 0xf0)};
    }
    static TwoLanes gather_pair(const std::int16_t* table, const std::uint32_t* place) {
        int first, second;
        __builtin_memcpy(&first, table + place[0], 4);
        __builtin_memcpy(&second, table + place[4], 4);
        return {_mm256_blend_epi32(_mm256_set1_epi32(first), _mm256_set1_epi32(second), 0xf0)};
    }

private:
    static __m256i everywhere(const std::uint8_t* p) {
        std::int64_t bytes;
        __builtin_memcpy(&bytes, p, 8);
        return _mm256_set1_epi64x(bytes);
    }
};

inline TwoLanes operator&(TwoLanes a, TwoLanes b) {
    return {_mm256_and_si256(a.v, b.v)};
}
inline TwoLanes operator|(TwoLanes a, TwoLanes b) {
    return {_mm256_or_si256(a.v, b.v)};
}
inline TwoLanes add16(TwoLanes a, TwoLanes b) {
    return {_mm256_add_epi16(a.v, b.v)};
}
inline TwoLanes sub16(TwoLanes a, TwoLanes b) {
    return {_mm256_sub_epi16(a.v, b.v)};
}
inline TwoLanes add32(TwoLanes a, TwoLanes b) {
    return {_mm256_add_epi32(a.v, b.v)};
}
inline TwoLanes times_q15(TwoLanes a, TwoLanes f) {
    return {_mm256_mulhrs_epi16(a.v, f.v)};
}
inline TwoLanes sums_of_word_pairs(TwoLanes a, TwoLanes w) {
    return {_mm256_madd_epi16(a.v, w.v)};
}
inline TwoLanes sums_of_byte_pairs(TwoLanes a, TwoLanes w) {
    return {_mm256_maddubs_epi16(a.v, w.v)};
}
inline TwoLanes shuffled(TwoLanes a, TwoLanes order) {
    return {_mm256_shuffle_epi8(a.v, order.v)};
}
inline TwoLanes low_halves(TwoLanes a, TwoLanes b) {
    return {_mm256_unpacklo_epi64(a.v, b.v)};
}
inline TwoLanes high_halves(TwoLanes a, TwoLanes b) {
    return {_mm256_unpackhi_epi64(a.v, b.v)};
}
inline TwoLanes words_of(TwoLanes a, TwoLanes b) {
    return {_mm256_packs_epi32(a.v, b.v)};
}
inline TwoLanes bytes_of(TwoLanes a, TwoLanes b) {
    return {_mm256_packus_epi16(a.v, b.v)};
}
inline TwoLanes with_odd_words(TwoLanes even, TwoLanes odd) {
    return {_mm256_blend_epi16(even.v, odd.v, 0xaa)};
}
template <int N>
TwoLanes right16(TwoLanes a) {
    return {_mm256_srli_epi16(a.v, N)};
}
template <int N>
TwoLanes right32(TwoLanes a) {
    return {_mm256_srli_epi32(a.v, N)};
}
template <int N>
TwoLanes signed_right32(TwoLanes a) {
    return {_mm256_srai_epi32(a.v, N)};
}
template <int N>
TwoLanes left32(TwoLanes a) {
    return {_mm256_slli_epi32(a.v, N)};
}
inline bool all_ones(TwoLanes a) {
    return _mm256_testc_si256(a.v, _mm256_set1_epi8(-1)) != 0;
}

#endif

}  // namespace

}  // namespace puppetwarp::detail
