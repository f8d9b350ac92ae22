#pragma once

#include <cstdint>

namespace puppetwarp::detail {

//! Phases of the tables: weights for fractions of 0, 1/1024, ..., 1.
inline constexpr int filter_phases = 1024;

//! Catmull-Rom weights in Q14, 4 a phase, each four of sum 2^14.
const std::int16_t* cubic_weights_q14();

//! Lanczos weights in Q14, 6 a phase and two zeros, each six of sum 2^14.
const std::int16_t* lanczos_weights_q14();

//! Lanczos weights, 6 a phase and two zeros, each six of sum 1.
const float* lanczos_weights();

}  // namespace puppetwarp::detail
