// Compiled with -msse4.1.
#include <puppetwarp/warp/sampling.h>

#if defined(__SSE4_1__)

#include <puppetwarp/warp/simd_samplers.h>

puppetwarp::detail::RunSampler puppetwarp::detail::find_sse41_sampler(const PixelFormat& format,
                                                                      Interpolation interpolation) {
    return simd_sampler(format, interpolation);
}

#else

puppetwarp::detail::RunSampler puppetwarp::detail::find_sse41_sampler(const PixelFormat&, Interpolation) {
    return nullptr;
}

#endif
