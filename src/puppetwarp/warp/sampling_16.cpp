#include <puppetwarp/warp/portable_sampler.h>

namespace puppetwarp::detail {

Samplers portable_samplers_16(const PixelFormat& format, Interpolation interpolation, bool linear) {
    return linear ? samplers_of_channels<std::uint16_t, Decoded>(format, interpolation)
                  : samplers_of_channels<std::uint16_t, Encoded>(format, interpolation);
}

}  // namespace puppetwarp::detail
