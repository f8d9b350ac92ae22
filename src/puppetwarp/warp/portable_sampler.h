#pragma once

#include <puppetwarp/warp/filters.h>

#include <cassert>

// Samplers from a codec and a filter.
namespace puppetwarp::detail {

//! What all samplers of a filter have in common, for `C` channels of type `T`.
template <class T, int C, class Filter>
Sampler sampler_of_taps(std::size_t out_bytes) {
    Sampler sampler;
    sampler.shift = -(std::int64_t{Filter::before} << 32);
    sampler.taps = Filter::taps;
    sampler.bytes_loaded = Filter::taps * C * static_cast<int>(sizeof(T));
    sampler.out_bytes = out_bytes;
    return sampler;
}

//! Premultiplied samples, `Four` each, of what `Codec` reads.
template <class Codec, class Filter>
struct BlendSampler {
    using T = typename Codec::Channel;
    static constexpr int C = Codec::channels;

    static void sample(const Source& source, const Places& places, int count, void* out) {
        const Codec codec(source);
        const auto load = [&](const T* p) { return codec.premultiplied(p); };
        Four* sample = static_cast<Four*>(out);
        for (int i = 0; i < count; ++i) {
            sample[i] = Filter::blend(InsideTaps<T, C>(source, places.first[i]), {places.fx[i], places.fy[i]}, load);
        }
    }

    static void sample_anywhere(const Source& source, const Run& run, void* out) {
        const Codec codec(source);
        const auto load = [&](const T* p) { return codec.premultiplied(p); };
        Four* sample = static_cast<Four*>(out);
        std::int64_t u = run.u, v = run.v;
        for (int i = 0; i < run.count; ++i, u += run.du, v += run.dv) {
            const ClampedTaps<T, C, Filter::taps> tap(source, (u >> 32) - Filter::before, (v >> 32) - Filter::before);
            sample[i] = Filter::blend(tap, Fractions(u, v), load);
        }
    }

    static Sampler sampler() {
        Sampler sampler = sampler_of_taps<T, C, Filter>(sizeof(Four));
        sampler.gives_pixels = false;
        sampler.sample = sample;
        sampler.sample_anywhere = sample_anywhere;
        return sampler;
    }
};

//! 8-bit pixels: whole-number arithmetic where the taps are opaque.
template <int C, class Filter>
struct ByteSampler {
    using Codec = Encoded<std::uint8_t, C>;

    template <class Taps>
    static void store(const Codec& codec, const Taps& tap, Fractions at, float fade, std::uint8_t* out) {
        if (fade < 1 || !opaque<Codec, Filter::taps>(tap)) {
            store_translucent(codec, tap, at, fade, out);
        } else {
            Filter::template store_opaque<C>(tap, at, out);
        }
    }

    template <class Taps>
    static void store_translucent(const Codec& codec, const Taps& tap, Fractions at, float fade, std::uint8_t* out) {
        const auto load = [&](const std::uint8_t* p) { return codec.premultiplied(p); };
        store_pixel(codec, Filter::blend(tap, at, load), fade, out);
    }

    static void sample(const Source& source, const Places& places, int count, void* out) {
        const Codec codec(source);
        auto* pixel = static_cast<std::uint8_t*>(out);
        for (int i = 0; i < count; ++i, pixel += C + source.adds_alpha) {
            const InsideTaps<std::uint8_t, C> tap(source, places.first[i]);
            store(codec, tap, {places.fx[i], places.fy[i]}, 1, pixel);
            if (source.adds_alpha) pixel[C] = 255;
        }
    }

    static void sample_anywhere(const Source& source, const Run& run, void* out) {
        const Codec codec(source);
        auto* pixel = static_cast<std::uint8_t*>(out);
        std::int64_t u = run.u, v = run.v;
        for (int i = 0; i < run.count; ++i, u += run.du, v += run.dv, pixel += C + source.adds_alpha) {
            const ClampedTaps<std::uint8_t, C, Filter::taps> tap(source, (u >> 32) - Filter::before,
                                                                 (v >> 32) - Filter::before);
            store(codec, tap, Fractions(u, v), Codec::has_alpha ? fade_at(source, u, v) : 1.0F, pixel);
            if (source.adds_alpha) pixel[C] = 255;
        }
    }

    static Sampler sampler(const PixelFormat& format) {
        Sampler sampler = sampler_of_taps<std::uint8_t, C, Filter>(format.out_bytes());
        sampler.sample = sample;
        sampler.sample_anywhere = sample_anywhere;
        return sampler;
    }
};

//! The pixel at a position, as it is.
template <class T, int C>
struct NearestSampler {
    static constexpr int taps = 1;
    static constexpr int before = 0;

    static void sample(const Source& source, const Places& places, int count, void* out) {
        T* pixel = static_cast<T*>(out);
        for (int i = 0; i < count; ++i, pixel += C + source.adds_alpha) {
            std::memcpy(pixel, source.data + sizeof(T) * std::size_t{places.first[i]}, sizeof(T) * C);
            if (source.adds_alpha) pixel[C] = Encoded<T, C>::full_value;
        }
    }

    static void sample_anywhere(const Source& source, const Run& run, void* out) {
        T* pixel = static_cast<T*>(out);
        std::int64_t u = run.u + half, v = run.v + half;
        for (int i = 0; i < run.count; ++i, u += run.du, v += run.dv, pixel += C + source.adds_alpha) {
            const ClampedTaps<T, C, 1> tap(source, u >> 32, v >> 32);
            const bool inside = u >= 0 && v >= 0 && u >> 32 < source.width && v >> 32 < source.height;
            if (Encoded<T, C>::has_alpha && !inside) {
                std::fill_n(pixel, C, T{});
            } else {
                std::memcpy(pixel, tap(0, 0), sizeof(T) * C);
            }
            if (source.adds_alpha) pixel[C] = Encoded<T, C>::full_value;
        }
    }

    static Sampler sampler(const PixelFormat& format) {
        Sampler sampler = sampler_of_taps<T, C, NearestSampler>(format.out_bytes());
        sampler.shift = half;
        sampler.sample = sample;
        sampler.sample_anywhere = sample_anywhere;
        return sampler;
    }

private:
    static constexpr std::int64_t half = std::int64_t{1} << 31;
};

template <class Codec>
void store_means(const Source& source, const void* samples, const float* fades, int count, int samples_a_pixel,
                 void* out) {
    using T = typename Codec::Channel;
    constexpr int C = Codec::channels;
    const Codec codec(source);
    const Four* sample = static_cast<const Four*>(samples);
    const float share = 1.0F / static_cast<float>(samples_a_pixel);
    T* pixel = static_cast<T*>(out);
    for (int i = 0; i < count; ++i, pixel += C + source.adds_alpha) {
        // Differences: the mean of equal numbers is the same number.
        const Four first = sample[i];
        Four rest = {};
        float fade = fades != nullptr ? fades[i] : 1.0F;
        for (int k = 1; k < samples_a_pixel; ++k) {
            rest += sample[k * count + i] - first;
            fade += fades != nullptr ? fades[k * count + i] : 1.0F;
        }
        if (samples_a_pixel == 1) {
            store_pixel(codec, first, fade, pixel);
        } else {
            store_pixel(codec, first + rest * share, fade * share, pixel);
        }
        if (source.adds_alpha) pixel[C] = Codec::full_value;
    }
}

template <class Codec>
void read_premultiplied(const Source& source, int x, int y, int count, float* out) {
    using T = typename Codec::Channel;
    constexpr int C = Codec::channels;
    const Codec codec(source);
    const T* from = reinterpret_cast<const T*>(source.data + static_cast<std::size_t>(y) * source.step) + C * x;
    for (int i = 0; i < count; ++i, from += C, out += C) {
        const Four value = codec.premultiplied(from);
        std::memcpy(out, &value, sizeof(float) * C);
    }
}

template <class Codec>
Sampler blend_sampler(Interpolation interpolation) {
    switch (interpolation) {
        case Interpolation::nearest: break;
        case Interpolation::bilinear: return BlendSampler<Codec, Bilinear>::sampler();
        case Interpolation::bicubic: return BlendSampler<Codec, Bicubic>::sampler();
        case Interpolation::lanczos3: return BlendSampler<Codec, Lanczos3>::sampler();
    }
    return {};
}

template <class Codec>
Samplers samplers_of(const PixelFormat& format, Interpolation interpolation) {
    using T = typename Codec::Channel;
    const Sampler blended = blend_sampler<Codec>(interpolation);
    const bool nearest = interpolation == Interpolation::nearest;
    return {nearest ? NearestSampler<T, Codec::channels>::sampler(format) : blended, blended, store_means<Codec>,
            read_premultiplied<Codec>};
}

//! \tparam Codec  of a number of channels.
template <class T, template <class, int> class Codec>
Samplers samplers_of_channels(const PixelFormat& format, Interpolation interpolation) {
    switch (format.channels) {
        case 1: return samplers_of<Codec<T, 1>>(format, interpolation);
        case 2: return samplers_of<Codec<T, 2>>(format, interpolation);
        case 3: return samplers_of<Codec<T, 3>>(format, interpolation);
        default: return samplers_of<Codec<T, 4>>(format, interpolation);
    }
}

}  // namespace puppetwarp::detail
