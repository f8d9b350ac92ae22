#include <puppetwarp/warp/sampling.h>

namespace puppetwarp::detail {

Simd best_simd() {
#if defined(__x86_64__)
    if (__builtin_cpu_supports("avx2")) return Simd::avx2;
    if (__builtin_cpu_supports("sse4.1")) return Simd::sse41;
#endif
    return Simd::scalar;
}

namespace {

void place_portable(const Source& source, const Span* spans, int count, const Steps* steps, const Places& places) {
    const auto row = static_cast<std::uint32_t>(source.step / source.channel_bytes);
    const auto pixel = static_cast<std::uint32_t>(source.channels);
    std::uint32_t *first = places.first, *fx = places.fx, *fy = places.fy;
    for (const Span* span = spans; span != spans + count; ++span) {
        std::int64_t u = span->u, v = span->v;
        const Steps& step = steps[span->steps];
        for (int i = 0; i < span->count; ++i, u += step.du, v += step.dv) {
            *first++ = static_cast<std::uint32_t>(v >> 32) * row + static_cast<std::uint32_t>(u >> 32) * pixel;
            *fx++ = static_cast<std::uint32_t>(u);
            *fy++ = static_cast<std::uint32_t>(v);
        }
    }
}

void accelerate(const Stored& stored, Interpolation interpolation, Simd simd, Sampler& sampler) {
    sampler.place = place_portable;
    if (simd >= Simd::sse41) accelerate_sse41(stored, interpolation, sampler);
    if (simd == Simd::avx2) accelerate_avx2(stored, interpolation, sampler);
}

}  // namespace

Samplers find_samplers(const PixelFormat& format, Interpolation interpolation, bool linear, Simd simd) {
    Samplers samplers = format.depth == CV_8U    ? portable_samplers_8(format, interpolation, linear)
                        : format.depth == CV_16U ? portable_samplers_16(format, interpolation, linear)
                                                 : portable_samplers_float(format, interpolation);
    const Stored stored{format.depth, format.channels, linear ? Stored::As::decoded : Stored::As::encoded};
    accelerate(stored, interpolation, simd, samplers.single);
    accelerate(stored, interpolation, simd, samplers.several);
    return samplers;
}

Sampler level_sampler(int channels, Interpolation interpolation, Simd simd) {
    Sampler sampler = portable_level_sampler(channels, interpolation);
    accelerate({CV_32F, channels, Stored::As::premultiplied}, interpolation, simd, sampler);
    return sampler;
}

}  // namespace puppetwarp::detail
