#include "noise.h"

#include <cmath>

namespace samples {

namespace {

// An integer is scrambled by multiplying with odd numbers and folding its high bits into the low ones.
std::uint32_t scramble(std::uint32_t value) {
    value ^= value >> 16;
    value *= 0x45d9f3bU;
    value ^= value >> 15;
    value *= 0x2c1b3c6dU;
    value ^= value >> 16;
    return value;
}

}  // namespace

float random_at(int x, int y, std::uint32_t seed) {
    const std::uint32_t cell =
        scramble(static_cast<std::uint32_t>(x) + scramble(static_cast<std::uint32_t>(y) + seed * 7919U));
    return static_cast<float>(cell >> 8) / 16777216.0F;
}

float smooth_noise(Vec p, std::uint32_t seed) {
    const float left = std::floor(p.x), top = std::floor(p.y);
    const int x = static_cast<int>(left), y = static_cast<int>(top);
    const float u = smooth_step(0, 1, p.x - left), v = smooth_step(0, 1, p.y - top);
    const float above = mix(random_at(x, y, seed), random_at(x + 1, y, seed), u);
    const float below = mix(random_at(x, y + 1, seed), random_at(x + 1, y + 1, seed), u);
    return 2 * mix(above, below, v) - 1;
}

float fractal_noise(Vec p, int octaves, std::uint32_t seed) {
    float sum = 0, strength = 0.5F;
    for (int octave = 0; octave < octaves; ++octave) {
        sum += strength * smooth_noise(p, seed + static_cast<std::uint32_t>(octave));
        p *= 2.0F;
        strength /= 2;
    }
    return sum;
}

float grain(int x, int y, std::uint32_t seed) {
    float sum = -2;
    for (std::uint32_t draw = 0; draw < 4; ++draw) sum += random_at(x, y, seed + draw);
    return sum * 1.7320508F;
}

}  // namespace samples
