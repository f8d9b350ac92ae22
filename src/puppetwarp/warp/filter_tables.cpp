#include <puppetwarp/warp/filter_tables.h>

#include <array>
#include <cstddef>

namespace puppetwarp::detail {

namespace {

constexpr std::size_t rows = filter_phases + 1;

// The compiler makes the tables: a library's sine may differ from the next one's.
constexpr double sine_of_pi(double x) {
    double sign = 1;
    while (x > 0.5) {
        x -= 1;
        sign = -sign;
    }
    while (x < -0.5) {
        x += 1;
        sign = -sign;
    }
    const double y = 3.14159265358979323846 * x;
    double term = y, sum = y;
    for (int k = 3; k < 24; k += 2) {
        term *= -y * y / (k * (k - 1));
        sum += term;
    }
    return sign * sum;
}

constexpr double sinc(double x) {
    return x == 0 ? 1 : sine_of_pi(x) / (3.14159265358979323846 * x);
}

struct Cubic {
    static constexpr std::size_t taps = 4, stride = 4;
    static constexpr std::array<double, taps> at(double f) {
        return {((-0.5 * f + 1) * f - 0.5) * f, (1.5 * f - 2.5) * f * f + 1, ((-1.5 * f + 2) * f + 0.5) * f,
                (0.5 * f - 0.5) * f * f};
    }
};

struct Lanczos {
    static constexpr std::size_t taps = 6, stride = 8;
    static constexpr std::array<double, taps> at(double f) {
        std::array<double, taps> weights{};
        double sum = 0;
        for (std::size_t k = 0; k < taps; ++k) {
            const double t = f + 2 - static_cast<double>(k);
            weights[k] = sinc(t) * sinc(t / 3);
            sum += weights[k];
        }
        double mean = -2 - f;
        for (std::size_t k = 0; k < taps; ++k) {
            weights[k] /= sum;
            mean += weights[k] * static_cast<double>(k);
        }
        // Off by a hundredth of a pixel at most. A ramp stays a ramp.
        weights[2] += mean;
        weights[3] -= mean;
        return weights;
    }
};

constexpr double fraction(std::size_t phase) {
    return static_cast<double>(phase) / filter_phases;
}

template <class Filter>
constexpr auto make_q14() {
    std::array<std::int16_t, Filter::stride * rows> table{};
    for (std::size_t phase = 0; phase < rows; ++phase) {
        const auto weights = Filter::at(fraction(phase));
        int sum = 0;
        for (std::size_t k = 0; k < Filter::taps; ++k) {
            const auto q14 = static_cast<std::int16_t>(weights[k] * 16384 + (weights[k] < 0 ? -0.5 : 0.5));
            table[Filter::stride * phase + k] = q14;
            sum += q14;
        }
        // The nearest tap takes what rounding left over: a constant stays constant.
        const std::size_t nearest_tap = Filter::taps / 2 - (2 * phase < filter_phases ? 1 : 0);
        std::int16_t& largest = table[Filter::stride * phase + nearest_tap];
        largest = static_cast<std::int16_t>(largest + 16384 - sum);
    }
    return table;
}

template <class Filter>
constexpr auto make_floats() {
    std::array<float, Filter::stride * rows> table{};
    for (std::size_t phase = 0; phase < rows; ++phase) {
        const auto weights = Filter::at(fraction(phase));
        for (std::size_t k = 0; k < Filter::taps; ++k) {
            table[Filter::stride * phase + k] = static_cast<float>(weights[k]);
        }
    }
    return table;
}

alignas(16) constexpr auto cubic_q14 = make_q14<Cubic>();
alignas(16) constexpr auto lanczos_q14 = make_q14<Lanczos>();
alignas(16) constexpr auto lanczos_floats = make_floats<Lanczos>();

}  // namespace

const std::int16_t* cubic_weights_q14() {
    return cubic_q14.data();
}

const std::int16_t* lanczos_weights_q14() {
    return lanczos_q14.data();
}

const float* lanczos_weights() {
    return lanczos_floats.data();
}

}  // namespace puppetwarp::detail
