#include <puppetwarp/warp/portable_sampler.h>

namespace puppetwarp::detail {

namespace {

template <int C>
Sampler byte_sampler(const PixelFormat& format, Interpolation interpolation) {
    switch (interpolation) {
        case Interpolation::nearest: break;
        case Interpolation::bilinear: return ByteSampler<C, Bilinear>::sampler(format);
        case Interpolation::bicubic: return ByteSampler<C, Bicubic>::sampler(format);
        case Interpolation::lanczos3: return ByteSampler<C, Lanczos3>::sampler(format);
    }
    assert(false);
    return {};
}

Sampler byte_sampler_of_channels(const PixelFormat& format, Interpolation interpolation) {
    switch (format.channels) {
        case 1: return byte_sampler<1>(format, interpolation);
        case 2: return byte_sampler<2>(format, interpolation);
        case 3: return byte_sampler<3>(format, interpolation);
        default: return byte_sampler<4>(format, interpolation);
    }
}

template <int C, class Filter>
void replace_translucent(const Source& source, const Places& places, int count, const void* samples,
                         std::uint8_t* out) {
    using Codec = Encoded<std::uint8_t, C>;
    const Codec codec(source);
    const Four* sample = static_cast<const Four*>(samples);
    for (int i = 0; i < count; ++i, out += C) {
        const InsideTaps<std::uint8_t, C> tap(source, places.first[i]);
        if (!opaque<Codec, Filter::taps>(tap)) store_pixel(codec, sample[i], 1, out);
    }
}

template <int C, class Filter>
TranslucentPixels translucent() {
    return {BlendSampler<Encoded<std::uint8_t, C>, Filter>::sample, replace_translucent<C, Filter>};
}

template <int C>
TranslucentPixels translucent_of_filter(Interpolation interpolation) {
    switch (interpolation) {
        case Interpolation::nearest: break;
        case Interpolation::bilinear: return translucent<C, Bilinear>();
        case Interpolation::bicubic: return translucent<C, Bicubic>();
        case Interpolation::lanczos3: return translucent<C, Lanczos3>();
    }
    return {};
}

}  // namespace

Samplers portable_samplers_8(const PixelFormat& format, Interpolation interpolation, bool linear) {
    if (linear) return samplers_of_channels<std::uint8_t, Decoded>(format, interpolation);
    Samplers samplers = samplers_of_channels<std::uint8_t, Encoded>(format, interpolation);
    if (interpolation != Interpolation::nearest) samplers.single = byte_sampler_of_channels(format, interpolation);
    return samplers;
}

TranslucentPixels translucent_pixels(int channels, Interpolation interpolation) {
    return channels == 2 ? translucent_of_filter<2>(interpolation) : translucent_of_filter<4>(interpolation);
}

}  // namespace puppetwarp::detail
