#include <puppetwarp/warp/portable_sampler.h>

namespace puppetwarp::detail {

Samplers portable_samplers_float(const PixelFormat& format, Interpolation interpolation) {
    return samplers_of_channels<float, Encoded>(format, interpolation);
}

Sampler portable_level_sampler(int channels, Interpolation interpolation) {
    switch (channels) {
        case 1: return blend_sampler<Blended<1>>(interpolation);
        case 2: return blend_sampler<Blended<2>>(interpolation);
        case 3: return blend_sampler<Blended<3>>(interpolation);
        default: return blend_sampler<Blended<4>>(interpolation);
    }
}

}  // namespace puppetwarp::detail
