#pragma once

#include "shapes.h"

#include <cstdint>

//! Randomness from integer hashes: the same in every run and on every machine.
namespace samples {

//! Uniform in [0, 1) for each cell and seed.
float random_at(int x, int y, std::uint32_t seed);

//! Smooth noise in [-1, 1] whose bumps are about 1 unit wide.
float smooth_noise(Vec p, std::uint32_t seed);

//! `octaves` smooth noises, each twice as fine and half as strong as the one before; about [-1, 1].
float fractal_noise(Vec p, int octaves, std::uint32_t seed);

//! About normal, mean 0, deviation 1: the grain of a camera.
float grain(int x, int y, std::uint32_t seed);

}  // namespace samples
