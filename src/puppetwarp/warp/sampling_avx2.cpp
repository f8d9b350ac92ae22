// Compiled with -mavx2.
#include <puppetwarp/warp/sampling.h>

#if defined(__AVX2__)

#include <puppetwarp/warp/simd_samplers.h>

#include <puppetwarp/warp/avx2_bilinear.h>

puppetwarp::detail::RunSampler puppetwarp::detail::find_avx2_sampler(const PixelFormat& format,
                                                                     Interpolation interpolation) {
    if (interpolation == Interpolation::bilinear) return wide_bilinear_sampler(format);
    return simd_sampler(format, interpolation);
}

#else

puppetwarp::detail::RunSampler puppetwarp::detail::find_avx2_sampler(const PixelFormat&, Interpolation) {
    return nullptr;
}

#endif
