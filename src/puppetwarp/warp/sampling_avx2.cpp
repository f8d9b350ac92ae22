// Compiled with -mavx2.
#include <puppetwarp/warp/sampling.h>

#if defined(__AVX2__)

#include <puppetwarp/warp/lane_samplers.h>
#include <puppetwarp/warp/pair_samplers.h>

namespace puppetwarp::detail {

namespace {

template <>
struct BlendOf<TwoLanes> {
    template <int C>
    static Blend filter(Interpolation interpolation) {
        Sampler sampler;
        accelerate_filter_of_pairs<PairTaps<std::uint8_t, C, false>>(interpolation, sampler);
        return sampler.sample;
    }
};

// Eight positions in 64-bit lanes: 0, 1, 4, 5 and 2, 3, 6, 7. So the words of both are in order when shuffled together.
struct EightSteps {
    __m256i a, b, all;

    explicit EightSteps(std::int64_t step) {
        const __m256i once = _mm256_set1_epi64x(step), zero = _mm256_setzero_si256();
        a = _mm256_add_epi64(_mm256_blend_epi32(zero, once, 0xcc),
                             _mm256_blend_epi32(zero, _mm256_slli_epi64(once, 2), 0xf0));
        b = _mm256_add_epi64(a, _mm256_slli_epi64(once, 1));
        all = _mm256_slli_epi64(once, 3);
    }
};

struct EightPositions {
    __m256i a, b;

    EightPositions(std::int64_t start, const EightSteps& steps)
        : a(_mm256_add_epi64(_mm256_set1_epi64x(start), steps.a)),
          b(_mm256_add_epi64(_mm256_set1_epi64x(start), steps.b)) {}

    __m256i high_words() const { return words<_MM_SHUFFLE(3, 1, 3, 1)>(); }
    __m256i low_words() const { return words<_MM_SHUFFLE(2, 0, 2, 0)>(); }
    void advance(const EightSteps& steps) {
        a = _mm256_add_epi64(a, steps.all);
        b = _mm256_add_epi64(b, steps.all);
    }

private:
    template <int Order>
    __m256i words() const {
        return _mm256_castps_si256(_mm256_shuffle_ps(_mm256_castsi256_ps(a), _mm256_castsi256_ps(b), Order));
    }
};

void store(std::uint32_t* p, __m256i value) {
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(p), value);
}

void place_eight(const Source& source, const Span* spans, int count, const Steps* steps, const Places& places) {
    const __m256i row = _mm256_set1_epi32(static_cast<int>(source.step / source.channel_bytes));
    const __m256i pixel = _mm256_set1_epi32(source.channels);
    const std::size_t channel_bytes = source.channel_bytes;
    std::uint32_t *first = places.first, *fx = places.fx, *fy = places.fy;
    const Span* span = spans;
    while (span != spans + count) {
        const Steps& step = steps[span->steps];
        const EightSteps du(step.du), dv(step.dv);
        const auto ahead = reinterpret_cast<std::uintptr_t>(source.data) + static_cast<std::uintptr_t>(step.ahead);
        for (const int same = span->steps; span != spans + count && span->steps == same; ++span) {
            EightPositions u(span->u, du), v(span->v, dv);
            const int length = span->count;
            for (int i = 0; i < length; i += 8) {
                store(first + i, _mm256_add_epi32(_mm256_mullo_epi32(v.high_words(), row),
                                                  _mm256_mullo_epi32(u.high_words(), pixel)));
                store(fx + i, u.low_words());
                store(fy + i, v.low_words());
                __builtin_prefetch(reinterpret_cast<const void*>(ahead + first[i] * channel_bytes));
                u.advance(du);
                v.advance(dv);
            }
            first += length;
            fx += length;
            fy += length;
        }
    }
}

}  // namespace

void accelerate_avx2(const Stored& stored, Interpolation interpolation, Sampler& sampler) {
    sampler.place = place_eight;
    if (sampler.gives_pixels) {
        const bool bytes = stored.depth == CV_8U && stored.as == Stored::As::encoded;
        if (bytes) accelerate_bytes<TwoLanes>(stored.channels, interpolation, sampler);
    } else if (stored.as == Stored::As::premultiplied) {
        accelerate_pairs<float, true>(stored.channels, interpolation, sampler);
    } else if (stored.as == Stored::As::encoded) {
        switch (stored.depth) {
            case CV_8U: accelerate_pairs<std::uint8_t, false>(stored.channels, interpolation, sampler); break;
            case CV_16U: accelerate_pairs<std::uint16_t, false>(stored.channels, interpolation, sampler); break;
            default: accelerate_pairs<float, false>(stored.channels, interpolation, sampler);
        }
    }
}

}  // namespace puppetwarp::detail

#else

void puppetwarp::detail::accelerate_avx2(const Stored&, Interpolation, Sampler&) {}

#endif
