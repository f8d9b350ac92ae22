// Compiled with -msse4.1.
#include <puppetwarp/warp/sampling.h>

#if defined(__SSE4_1__)

#include <puppetwarp/warp/lane_samplers.h>

namespace puppetwarp::detail {

namespace {

// Positions `lane` and `lane + 1` of a run.
__m128i two_positions(std::int64_t start, std::int64_t step, int lane) {
    return _mm_set_epi64x(start + (lane + 1) * step, start + lane * step);
}

__m128i high_words(__m128i a, __m128i b) {
    return _mm_castps_si128(_mm_shuffle_ps(_mm_castsi128_ps(a), _mm_castsi128_ps(b), _MM_SHUFFLE(3, 1, 3, 1)));
}

__m128i low_words(__m128i a, __m128i b) {
    return _mm_castps_si128(_mm_shuffle_ps(_mm_castsi128_ps(a), _mm_castsi128_ps(b), _MM_SHUFFLE(2, 0, 2, 0)));
}

void place_four(const Source& source, const Span* spans, int count, const Steps* steps, const Places& places) {
    const __m128i row = _mm_set1_epi32(static_cast<int>(source.step / source.channel_bytes));
    const __m128i pixel = _mm_set1_epi32(source.channels);
    Places end = places;
    for (const Span* span = spans; span != spans + count; ++span) {
        const Steps& step = steps[span->steps];
        __m128i u01 = two_positions(span->u, step.du, 0), u23 = two_positions(span->u, step.du, 2);
        __m128i v01 = two_positions(span->v, step.dv, 0), v23 = two_positions(span->v, step.dv, 2);
        const __m128i du = _mm_set1_epi64x(4 * step.du), dv = _mm_set1_epi64x(4 * step.dv);
        for (int i = 0; i < span->count; i += 4) {
            const __m128i first =
                _mm_add_epi32(_mm_mullo_epi32(high_words(v01, v23), row), _mm_mullo_epi32(high_words(u01, u23), pixel));
            _mm_storeu_si128(reinterpret_cast<__m128i*>(end.first + i), first);
            _mm_storeu_si128(reinterpret_cast<__m128i*>(end.fx + i), low_words(u01, u23));
            _mm_storeu_si128(reinterpret_cast<__m128i*>(end.fy + i), low_words(v01, v23));
            u01 = _mm_add_epi64(u01, du);
            u23 = _mm_add_epi64(u23, du);
            v01 = _mm_add_epi64(v01, dv);
            v23 = _mm_add_epi64(v23, dv);
        }
        end = end + span->count;
    }
}

}  // namespace

void accelerate_sse41(const Stored& stored, Interpolation interpolation, Sampler& sampler) {
    sampler.place = place_four;
    const bool bytes = sampler.gives_pixels && stored.depth == CV_8U && stored.as == Stored::As::encoded;
    if (bytes) accelerate_bytes<OneLane>(stored.channels, interpolation, sampler);
}

}  // namespace puppetwarp::detail

#else

void puppetwarp::detail::accelerate_sse41(const Stored&, Interpolation, Sampler&) {}

#endif
