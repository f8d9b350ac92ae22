#include <puppetwarp/warp/filters.h>

#include <opencv2/core/hal/interface.h>

#include <array>
#include <cassert>

namespace puppetwarp::detail {

namespace {

constexpr int cubic_phases = 1024;

constexpr auto cubic_table = [] {
    std::array<std::int16_t, 4 * (cubic_phases + 1)> table{};
    for (int phase = 0; phase <= cubic_phases; ++phase) {
        const double f = static_cast<double>(phase) / cubic_phases;
        const double weight[4] = {((-0.5 * f + 1) * f - 0.5) * f, (1.5 * f - 2.5) * f * f + 1,
                                  ((-1.5 * f + 2) * f + 0.5) * f, (0.5 * f - 0.5) * f * f};
        int sum = 0;
        for (int k = 0; k < 4; ++k) {
            const auto q14 = static_cast<std::int16_t>(weight[k] * 16384 + (weight[k] < 0 ? -0.5 : 0.5));
            table[4 * static_cast<std::size_t>(phase) + static_cast<std::size_t>(k)] = q14;
            sum += q14;
        }
        // The nearest tap takes what rounding left over: a constant stays constant.
        const std::size_t nearest_tap = 2 * phase < cubic_phases ? 1 : 2;
        std::int16_t& largest = table[4 * static_cast<std::size_t>(phase) + nearest_tap];
        largest = static_cast<std::int16_t>(largest + 16384 - sum);
    }
    return table;
}();

template <int C, bool AddsAlpha, class T>
void store_full_alpha(T* out) {
    if constexpr (AddsAlpha) out[C] = static_cast<T>(Pixel<T, C>::full);
}

template <class Filter, class T, int C>
void store_filtered(const SourceView& source, const Position& at, float fade, T* out) {
    using P = Pixel<T, C>;
    const Taps<T, C, Filter::taps> tap(source, at.x - Filter::before, at.y - Filter::before);
    if constexpr (P::has_alpha) {
        if (fade < 1 || !tap.opaque()) {
            P::store_straight(Filter::template blend<T, C>(tap, at, P::premultiplied), fade, out);
            return;
        }
    }
    if constexpr (std::is_same_v<T, std::uint8_t>) {
        Filter::template store_opaque<C>(tap, at, out);
    } else {
        P::store(Filter::template blend<T, C>(tap, at, P::load), out);
    }
}

template <class Filter, class T, int C, bool AddsAlpha>
void sample_filtered(const SourceView& source, const Run& run, void* out) {
    T* pixel = static_cast<T*>(out);
    std::int64_t u = run.u, v = run.v;
    for (int i = 0; i < run.count; ++i, u += run.du, v += run.dv) {
        const float fade = Pixel<T, C>::has_alpha ? fade_at(source, u, v) : 1.0F;
        store_filtered<Filter, T, C>(source, Position(u, v), fade, pixel);
        store_full_alpha<C, AddsAlpha>(pixel);
        pixel += C + AddsAlpha;
    }
}

template <class T, int C, bool AddsAlpha>
void sample_nearest(const SourceView& source, const Run& run, void* out) {
    constexpr std::int64_t half = std::int64_t{1} << 31;
    T* pixel = static_cast<T*>(out);
    std::int64_t u = run.u + half, v = run.v + half;
    for (int i = 0; i < run.count; ++i, u += run.du, v += run.dv) {
        const Position at(u, v);
        const int x = std::clamp(at.x, 0, source.width - 1), y = std::clamp(at.y, 0, source.height - 1);
        if (Pixel<T, C>::has_alpha && (x != at.x || y != at.y)) {
            std::fill_n(pixel, C, T{});
        } else {
            const std::uint8_t* from = source.data + static_cast<std::size_t>(y) * source.step;
            std::memcpy(pixel, from + sizeof(T) * C * static_cast<std::size_t>(x), sizeof(T) * C);
        }
        store_full_alpha<C, AddsAlpha>(pixel);
        pixel += C + AddsAlpha;
    }
}

template <class T, int C, bool AddsAlpha>
RunSampler of_filter(Interpolation interpolation) {
    switch (interpolation) {
        case Interpolation::nearest: return sample_nearest<T, C, AddsAlpha>;
        case Interpolation::bilinear: return sample_filtered<Bilinear, T, C, AddsAlpha>;
        case Interpolation::bicubic: return sample_filtered<Bicubic, T, C, AddsAlpha>;
    }
    assert(false);
    return nullptr;
}

template <class T>
RunSampler of_channels(const PixelFormat& format, Interpolation interpolation) {
    switch (format.channels) {
        case 1: return format.adds_alpha ? of_filter<T, 1, true>(interpolation) : of_filter<T, 1, false>(interpolation);
        case 2: return of_filter<T, 2, false>(interpolation);
        case 3: return format.adds_alpha ? of_filter<T, 3, true>(interpolation) : of_filter<T, 3, false>(interpolation);
        default: return of_filter<T, 4, false>(interpolation);
    }
}

}  // namespace

const std::int16_t* cubic_weight_table() {
    return cubic_table.data();
}

RunSampler find_scalar_sampler(const PixelFormat& format, Interpolation interpolation) {
    switch (format.depth) {
        case CV_8U: return of_channels<std::uint8_t>(format, interpolation);
        case CV_16U: return of_channels<std::uint16_t>(format, interpolation);
        default: return of_channels<float>(format, interpolation);
    }
}

}  // namespace puppetwarp::detail
