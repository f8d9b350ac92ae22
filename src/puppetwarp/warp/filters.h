#pragma once

#include <puppetwarp/warp/sampling.h>

#include <algorithm>
#include <cstring>
#include <limits>
#include <type_traits>

// One pixel from its taps, as sampling.h specifies, in portable code.
namespace puppetwarp::detail {

//! Four binary32 numbers: the channels of a pixel. Element-wise, so the same bits whatever the compiler makes of it.
using Four = float __attribute__((vector_size(16)));

//! How pixels of one depth and number of channels are stored.
template <class T, int C>
struct Pixel {
    static constexpr bool is_float = std::is_floating_point_v<T>;
    static constexpr bool has_alpha = C % 2 == 0;
    static constexpr int alpha = C - 1;  // its index, with has_alpha
    static constexpr float full = is_float ? 1.0F : static_cast<float>(std::numeric_limits<T>::max());

    static Four load(const T* p) {
        Four value = {};
        for (int c = 0; c < C; ++c) value[c] = static_cast<float>(p[c]);
        return value;
    }

    static T rounded(float value) {
        if constexpr (is_float) {
            return value;
        } else {
            return static_cast<T>(static_cast<int>(std::clamp(value + 0.5F, 0.0F, full)));
        }
    }

    //! Colour multiplied by alpha.
    static Four premultiplied(const T* p) {
        const Four value = load(p);
        const float a = value[alpha];
        Four factor = {a, a, a, a};
        factor[alpha] = 1;
        return value * factor;
    }

    //! Straight from premultiplied, rounded. \param fade  factor of alpha.
    static void store_straight(Four value, float fade, T* out) {
        const float a = value[alpha];
        const float shown = std::clamp(a, 0.0F, full) * fade;
        if (is_float ? !(shown >= 0x1p-20F) : shown < 0.5F) {
            std::fill_n(out, C, T{});
            return;
        }
        const Four straight = value / Four{a, a, a, a};
        for (int c = 0; c < alpha; ++c) out[c] = rounded(straight[c]);
        out[alpha] = rounded(shown);
    }

    static void store(Four value, T* out) {
        for (int c = 0; c < C; ++c) out[c] = rounded(value[c]);
    }
};

inline float leading_bits(std::uint32_t fraction) {
    return static_cast<float>(static_cast<std::int32_t>(fraction >> 9)) * 0x1p-23F;
}

//! Where a pixel's taps begin, and how far into it the position lies.
struct Position {
    int x, y;
    std::uint32_t fx, fy;

    Position(std::int64_t u, std::int64_t v)
        : x(static_cast<int>(u >> 32)),
          y(static_cast<int>(v >> 32)),
          fx(static_cast<std::uint32_t>(u)),
          fy(static_cast<std::uint32_t>(v)) {}
};

//! Pointers to N x N taps around a position.
template <class T, int C, int N>
struct Taps {
    const T* row[N];
    int column[N];  // in elements

    //! \param first_x,first_y  of the first tap.
    Taps(const SourceView& source, int first_x, int first_y) {
        const auto at = [&](int y) {
            return reinterpret_cast<const T*>(source.data + static_cast<std::size_t>(y) * source.step);
        };
        for (int k = 0; k < N; ++k) {
            row[k] = at(std::clamp(first_y + k, 0, source.height - 1));
            column[k] = C * std::clamp(first_x + k, 0, source.width - 1);
        }
    }

    const T* operator()(int r, int c) const { return row[r] + column[c]; }

    bool opaque() const {
        bool all = true;
        for (int r = 0; r < N; ++r) {
            for (int c = 0; c < N; ++c) all &= static_cast<float>((*this)(r, c)[C - 1]) == Pixel<T, C>::full;
        }
        return all;
    }
};

//! Alpha's factor outside the picture.
inline float fade_along(std::int64_t u, int size) {
    constexpr std::int64_t one = std::int64_t{1} << 32;
    const std::int64_t inside = std::min(u + one, size * one - u);  // 1/2 on the border, 0 half a pixel outside
    return std::clamp(static_cast<float>(inside) * 0x1p-31F, 0.0F, 1.0F);
}

inline float fade_at(const SourceView& source, std::int64_t u, std::int64_t v) {
    return fade_along(u, source.width) * fade_along(v, source.height);
}

struct Bilinear {
    static constexpr int taps = 2;
    static constexpr int before = 0;  // taps before floor(u)

    template <int C>
    static void store_opaque(const Taps<std::uint8_t, C, 2>& tap, const Position& at, std::uint8_t* out) {
        const int fx = static_cast<int>(at.fx >> 17), fy = static_cast<int>(at.fy >> 17);
        const auto lerp = [](int a, int b, int f) { return a + (((b - a) * f + (1 << 14)) >> 15); };
        for (int c = 0; c < C; ++c) {
            const int left = lerp(tap(0, 0)[c] << 7, tap(1, 0)[c] << 7, fy);
            const int right = lerp(tap(0, 1)[c] << 7, tap(1, 1)[c] << 7, fy);
            out[c] = static_cast<std::uint8_t>((lerp(left, right, fx) + 64) >> 7);
        }
    }

    template <class T, int C, class Load>
    static Four blend(const Taps<T, C, 2>& tap, const Position& at, const Load& load) {
        const float fx = leading_bits(at.fx), fy = leading_bits(at.fy);
        const Four a = load(tap(0, 0)), b = load(tap(0, 1));
        const Four left = a + (load(tap(1, 0)) - a) * fy;
        const Four right = b + (load(tap(1, 1)) - b) * fy;
        return left + (right - left) * fx;
    }
};

struct Bicubic {
    static constexpr int taps = 4;
    static constexpr int before = 1;

    static const std::int16_t* weights(std::uint32_t fraction) {
        return cubic_weight_table() + 4 * (((fraction >> 21) + 1) >> 1);
    }

    template <int C>
    static void store_opaque(const Taps<std::uint8_t, C, 4>& tap, const Position& at, std::uint8_t* out) {
        const std::int16_t* wx = weights(at.fx);
        const std::int16_t* wy = weights(at.fy);
        for (int c = 0; c < C; ++c) {
            int sum = 0;
            for (int k = 0; k < 4; ++k) {
                const int column =
                    tap(0, k)[c] * wy[0] + tap(1, k)[c] * wy[1] + tap(2, k)[c] * wy[2] + tap(3, k)[c] * wy[3];
                sum += ((column + 128) >> 8) * wx[k];
            }
            out[c] = static_cast<std::uint8_t>(std::clamp((sum + (1 << 19)) >> 20, 0, 255));
        }
    }

    struct Weights {
        float w0, w2, w3;
        explicit Weights(float f)
            : w0(((-0.5F * f + 1.0F) * f - 0.5F) * f),
              w2(((-1.5F * f + 2.0F) * f + 0.5F) * f),
              w3((0.5F * f - 0.5F) * f * f) {}
        Four operator()(Four p0, Four p1, Four p2, Four p3) const {
            return p1 + (p0 - p1) * w0 + (p2 - p1) * w2 + (p3 - p1) * w3;
        }
    };

    template <class T, int C, class Load>
    static Four blend(const Taps<T, C, 4>& tap, const Position& at, const Load& load) {
        const Weights wx(leading_bits(at.fx)), wy(leading_bits(at.fy));
        Four column[4];
        for (int k = 0; k < 4; ++k) {
            column[k] = wy(load(tap(0, k)), load(tap(1, k)), load(tap(2, k)), load(tap(3, k)));
        }
        return wx(column[0], column[1], column[2], column[3]);
    }
};

}  // namespace puppetwarp::detail
