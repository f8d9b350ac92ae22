#pragma once
// Private header.

#include <algorithm>
#include <cmath>
#include <type_traits>

namespace puppetwarp {

//! Between what pictures hold and float numbers of full scale 1, premultiplied.
template <class T>
struct Values {
    static constexpr double full = std::is_floating_point_v<T> ? 1.0 : static_cast<double>(static_cast<T>(-1));

    static float read(T value) {
        const auto number = static_cast<float>(static_cast<double>(value) * (1 / full));
        return std::isfinite(number) ? number : 0.0F;
    }
    static T written(double value) {
        if constexpr (std::is_floating_point_v<T>) {
            return static_cast<T>(value);
        } else {
            return static_cast<T>(std::clamp(value * full + 0.5, 0.0, full));
        }
    }

    static void load(const T* from, int channels, float* to) {
        const bool has_alpha = channels % 2 == 0;
        const float alpha = has_alpha ? read(from[channels - 1]) : 1;
        for (int c = 0; c < channels - has_alpha; ++c) to[c] = read(from[c]) * alpha;
        if (has_alpha) to[channels - 1] = alpha;
    }

    static void store(const float* from, int channels, T* to) {
        const bool has_alpha = channels % 2 == 0;
        const double alpha = has_alpha ? static_cast<double>(from[channels - 1]) : 1;
        for (int c = 0; c < channels - has_alpha; ++c) to[c] = written(alpha > 0 ? from[c] / alpha : 0);
        if (has_alpha) to[channels - 1] = written(alpha);
    }
};

}  // namespace puppetwarp
