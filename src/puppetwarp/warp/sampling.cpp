#include <puppetwarp/warp/sampling.h>

#include <limits>

namespace puppetwarp::detail {

Simd best_simd() {
#if defined(__x86_64__)
    if (__builtin_cpu_supports("avx2")) return Simd::avx2;
    if (__builtin_cpu_supports("sse4.1")) return Simd::sse41;
#endif
    return Simd::scalar;
}

RunSampler find_run_sampler(const PixelFormat& format, Interpolation interpolation, Simd simd,
                            const SourceView& source) {
    // SIMD code adds 32-bit offsets to the address of the picture.
    const bool addressable =
        source.step * static_cast<std::size_t>(source.height) < std::size_t{std::numeric_limits<std::int32_t>::max()};
    if (addressable && simd == Simd::avx2) {
        if (const RunSampler sampler = find_avx2_sampler(format, interpolation)) return sampler;
    }
    if (addressable && simd >= Simd::sse41) {
        if (const RunSampler sampler = find_sse41_sampler(format, interpolation)) return sampler;
    }
    return find_scalar_sampler(format, interpolation);
}

}  // namespace puppetwarp::detail
