#pragma once

#include <bit>
#include <cstdint>

namespace puppetwarp {

// Elementary functions for loops over pixels: a few roundings of float from exact, the same on every processor, and
// plain enough for the compiler to do four at a time.

//! Logarithm to base 2 of a normal number above 0: the exponent, and of the rest m in [1 / sqrt 2, sqrt 2) the series
//! of 2 artanh((m - 1) / (m + 1)).
inline float fast_log2(float value) {
    constexpr std::int32_t root_half = 0x3f3504f3;  // the bits of sqrt(1 / 2)
    const auto bits = std::bit_cast<std::int32_t>(value);
    const std::int32_t exponent = (bits - root_half) >> 23;
    const auto rest = std::bit_cast<float>(bits - (exponent << 23));
    const float s = (rest - 1) / (rest + 1);
    const float s2 = s * s;
    constexpr float scale = 2.88539008F;  // 2 / ln 2
    const float series = 1 + s2 * (1 / 3.0F + s2 * (1 / 5.0F + s2 * (1 / 7.0F + s2 * (1 / 9.0F))));
    return static_cast<float>(exponent) + scale * s * series;
}

//! 2 to a power in [-126, 127]: the nearest whole number, and of the rest the series of the exponential function.
inline float fast_exp2(float power) {
    const auto whole = static_cast<std::int32_t>(power + (power < 0 ? -0.5F : 0.5F));
    const float t = 0.693147181F * (power - static_cast<float>(whole));
    const float series =
        1 + t * (1 + t * (1 / 2.0F + t * (1 / 6.0F + t * (1 / 24.0F + t * (1 / 120.0F + t * (1 / 720.0F))))));
    return series * std::bit_cast<float>((whole + 127) << 23);
}

//! `value` to a power, 0 for values up to 1e-30.
inline float fast_pow(float value, float power) {
    constexpr float least = 1e-30F;
    const float result = fast_exp2(power * fast_log2(value > least ? value : least));
    return value > least ? result : 0.0F;
}

}  // namespace puppetwarp
