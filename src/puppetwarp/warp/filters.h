#pragma once

#include <puppetwarp/warp/filter_tables.h>
#include <puppetwarp/warp/pixel_codec.h>

// One pixel from its taps, as sampling.h specifies, in portable code.
namespace puppetwarp::detail {

inline float leading_bits(std::uint32_t fraction) {
    return static_cast<float>(static_cast<std::int32_t>(fraction >> 9)) * 0x1p-23F;
}

inline std::uint32_t nearest_phase(std::uint32_t fraction) {
    return ((fraction >> 21) + 1) >> 1;
}

//! How far into its pixel a position lies.
struct Fractions {
    std::uint32_t x, y;

    Fractions(std::uint32_t fx, std::uint32_t fy) : x(fx), y(fy) {}
    Fractions(std::int64_t u, std::int64_t v) : x(static_cast<std::uint32_t>(u)), y(static_cast<std::uint32_t>(v)) {}
};

//! Taps inside the picture.
template <class T, int C>
struct InsideTaps {
    const std::uint8_t* first;
    std::size_t step;

    InsideTaps(const Source& source, std::uint32_t index)
        : first(source.data + std::size_t{index} * sizeof(T)), step(source.step) {}

    const T* operator()(int row, int column) const {
        return reinterpret_cast<const T*>(first + static_cast<std::size_t>(row) * step) + C * column;
    }
};

//! N x N taps anywhere: outside the picture its border is repeated.
template <class T, int C, int N>
struct ClampedTaps {
    const T* rows[N];
    int columns[N];  // in channels

    //! \param x,y  of the first tap.
    ClampedTaps(const Source& source, std::int64_t x, std::int64_t y) {
        for (int k = 0; k < N; ++k) {
            const auto row = static_cast<std::size_t>(std::clamp<std::int64_t>(y + k, 0, source.height - 1));
            rows[k] = reinterpret_cast<const T*>(source.data + row * source.step);
            columns[k] = C * static_cast<int>(std::clamp<std::int64_t>(x + k, 0, source.width - 1));
        }
    }

    const T* operator()(int row, int column) const { return rows[row] + columns[column]; }
};

//! Whether all N x N taps have full alpha, or none at all.
template <class Codec, int N, class Taps>
bool opaque(const Taps& tap) {
    if constexpr (!Codec::has_alpha) return true;
    for (int row = 0; row < N; ++row) {
        for (int column = 0; column < N; ++column) {
            if (tap(row, column)[Codec::channels - 1] != Codec::full_value) return false;
        }
    }
    return true;
}

//! Alpha's factor outside the picture.
inline float fade_along(std::int64_t u, int size) {
    constexpr std::int64_t one = std::int64_t{1} << 32;
    const std::int64_t inside = std::min(u + one, size * one - u);  // 1/2 on the border, 0 half a pixel outside
    return std::clamp(static_cast<float>(inside) * 0x1p-31F, 0.0F, 1.0F);
}

inline float fade_at(const Source& source, std::int64_t u, std::int64_t v) {
    return fade_along(u, source.width) * fade_along(v, source.height);
}

struct Bilinear {
    static constexpr int taps = 2;
    static constexpr int before = 0;  // taps before floor(u)

    template <int C, class Taps>
    static void store_opaque(const Taps& tap, Fractions at, std::uint8_t* out) {
        const int fx = static_cast<int>(at.x >> 17), fy = static_cast<int>(at.y >> 17);
        const auto lerp = [](int a, int b, int f) { return a + (((b - a) * f + (1 << 14)) >> 15); };
        for (int c = 0; c < C; ++c) {
            const int left = lerp(tap(0, 0)[c] << 6, tap(1, 0)[c] << 6, fy);
            const int right = lerp(tap(0, 1)[c] << 6, tap(1, 1)[c] << 6, fy);
            out[c] = static_cast<std::uint8_t>((lerp(left, right, fx) + 32) >> 6);
        }
    }

    template <class Taps, class Load>
    static Four blend(const Taps& tap, Fractions at, const Load& load) {
        const float fx = leading_bits(at.x), fy = leading_bits(at.y);
        const Four a = load(tap(0, 0)), b = load(tap(0, 1));
        const Four left = a + (load(tap(1, 0)) - a) * fy;
        const Four right = b + (load(tap(1, 1)) - b) * fy;
        return left + (right - left) * fx;
    }
};

//! 8 bits through weights in Q14, `stride` a phase.
template <int C, int N, class Taps>
void store_weighted(const Taps& tap, const std::int16_t* wx, const std::int16_t* wy, std::uint8_t* out) {
    for (int c = 0; c < C; ++c) {
        int sum = (1 << 19) + (1 << 13);
        for (int row = 0; row < N; ++row) {
            int along = 0;
            for (int column = 0; column < N; ++column) along += tap(row, column)[c] * wx[column];
            sum += (along >> 8) * wy[row];
        }
        out[c] = static_cast<std::uint8_t>(std::clamp(sum >> 20, 0, 255));
    }
}

struct Bicubic {
    static constexpr int taps = 4;
    static constexpr int before = 1;

    template <int C, class Taps>
    static void store_opaque(const Taps& tap, Fractions at, std::uint8_t* out) {
        const std::int16_t* table = cubic_weights_q14();
        store_weighted<C, 4>(tap, table + 4 * nearest_phase(at.x), table + 4 * nearest_phase(at.y), out);
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

    template <class Taps, class Load>
    static Four blend(const Taps& tap, Fractions at, const Load& load) {
        const Weights wx(leading_bits(at.x)), wy(leading_bits(at.y));
        Four column[4];
        for (int k = 0; k < 4; ++k) {
            column[k] = wy(load(tap(0, k)), load(tap(1, k)), load(tap(2, k)), load(tap(3, k)));
        }
        return wx(column[0], column[1], column[2], column[3]);
    }
};

struct Lanczos3 {
    static constexpr int taps = 6;
    static constexpr int before = 2;

    template <int C, class Taps>
    static void store_opaque(const Taps& tap, Fractions at, std::uint8_t* out) {
        const std::int16_t* table = lanczos_weights_q14();
        store_weighted<C, 6>(tap, table + 8 * nearest_phase(at.x), table + 8 * nearest_phase(at.y), out);
    }

    struct Weights {
        float w[6];
        explicit Weights(std::uint32_t fraction) {
            const float* phase = lanczos_weights() + 8 * (fraction >> 22);
            const float t = static_cast<float>(static_cast<std::int32_t>(fraction & 0x3fffff)) * 0x1p-22F;
            for (int k = 0; k < 6; ++k) w[k] = phase[k] + (phase[k + 8] - phase[k]) * t;
        }
        Four operator()(const Four* p) const {
            return p[2] + (p[0] - p[2]) * w[0] + (p[1] - p[2]) * w[1] + (p[3] - p[2]) * w[3] + (p[4] - p[2]) * w[4] +
                   (p[5] - p[2]) * w[5];
        }
    };

    template <class Taps, class Load>
    static Four blend(const Taps& tap, Fractions at, const Load& load) {
        const Weights wx(at.x), wy(at.y);
        Four column[6];
        for (int k = 0; k < 6; ++k) {
            Four tap_column[6];
            for (int row = 0; row < 6; ++row) tap_column[row] = load(tap(row, k));
            column[k] = wy(tap_column);
        }
        return wx(column);
    }
};

}  // namespace puppetwarp::detail
