// Compiled with -mavx2.
#include <puppetwarp/warp/sampling.h>

#if defined(__AVX2__)

#include <puppetwarp/warp/simd_samplers.h>

puppetwarp::detail::RunSampler puppetwarp::detail::find_avx2_sampler(const PixelFormat& format,
                                                                     Interpolation interpolation) {
    return simd_sampler(format, interpolation);
}

#else

puppetwarp::detail::RunSampler puppetwarp::detail::find_avx2_sampler(const PixelFormat&, Interpolation) {
    return nullptr;
}

#endif
