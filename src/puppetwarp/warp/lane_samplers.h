#pragma once

#include <puppetwarp/warp/filter_tables.h>
#include <puppetwarp/warp/lane_vectors.h>
#include <puppetwarp/warp/sampling.h>

// 8-bit filters, a pixel a 128-bit lane and four vectors at a time. Internal linkage for the reason given in
// lane_vectors.h. The first vector of two lanes holds pixels 0 and 4, the next 1 and 5: so the pixels are in order when
// they are packed, without a shuffle across lanes.
namespace puppetwarp::detail {

namespace {

struct LaneOrder {
    alignas(16) signed char at[16];
    __m128i lane() const { return _mm_load_si128(reinterpret_cast<const __m128i*>(at)); }
};

template <class Byte>
constexpr LaneOrder lane_order(const Byte& byte) {
    LaneOrder order{};
    for (int i = 0; i < 16; ++i) order.at[i] = static_cast<signed char>(byte(i));
    return order;
}

constexpr int no_byte = -1;

// From bytes of neighbouring pixels to pairs of words: channel c of pixels `left` and `left + 1`.
template <int C>
constexpr LaneOrder pixel_pairs(int left) {
    return lane_order([left](int i) {
        const int c = i / 4;
        return i % 2 == 1 || c >= C ? no_byte : C * (left + i / 2 % 2) + c;
    });
}

// Four pixels of 4 bytes to four of `channels`.
constexpr LaneOrder packing(int channels) {
    return lane_order([channels](int i) { return i >= 4 * channels ? no_byte : i / channels * 4 + i % channels; });
}

// All ones but for the alpha of `pixels` pixels side by side.
template <int C>
constexpr LaneOrder all_but_alpha(int pixels) {
    return lane_order([pixels](int i) { return i % C == C - 1 && i / C < pixels ? 0 : -1; });
}

constexpr LaneOrder word_of_dword(int low, int high) {
    return lane_order([=](int i) { return 4 * (i < 8 ? low : high) + i % 2; });
}

template <class V>
struct GroupOf {
    static constexpr int size = 4 * V::lanes;
    const std::uint8_t* address[4][V::lanes];

    GroupOf(const Source& source, const Places& places) {
        for (int k = 0; k < 4; ++k) {
            for (int lane = 0; lane < V::lanes; ++lane) address[k][lane] = source.data + places.first[k + 4 * lane];
        }
    }
};

struct LaneBilinear {
    static constexpr Interpolation interpolation = Interpolation::bilinear;
    template <int C>
    static constexpr int bytes_loaded = 8;

    // Pairs of bytes, upper and lower: the left pixel's channels, then the right one's.
    template <int C>
    static constexpr LaneOrder corners() {
        return lane_order([](int i) {
            const int c = i / 2 % 4;
            return c >= C ? no_byte : 8 * (i % 2) + C * (i / 8) + c;
        });
    }

    // Ones but for alpha, in that order.
    template <int C>
    static constexpr LaneOrder mask() {
        return lane_order([](int i) { return i / 2 % 4 == C - 1 ? 0 : -1; });
    }

    // The words of a pixel's left and right column, between the rows, Q6.
    template <class V>
    static V between_rows(V corners, V fy) {
        const V upper = sums_of_byte_pairs(corners, V::repeated(_mm_set1_epi16(64)));
        const V difference = sums_of_byte_pairs(corners, V::repeated(_mm_set1_epi16((64 << 8) | (256 - 64))));
        return add16(upper, times_q15(difference, fy));
    }

    // Two vectors of pixels.
    template <class V>
    static V between_columns(V p, V q, V fx) {
        const V left = low_halves(p, q);
        const V value = add16(left, times_q15(sub16(high_halves(p, q), left), fx));
        return right16<6>(add16(value, V::repeated(_mm_set1_epi16(32))));
    }

    // A group of pixels, 4 bytes each. \param all  gets the bits that all taps have.
    template <class V, int C>
    static V group(const Source& source, const Places& places, V& all) {
        constexpr LaneOrder order = corners<C>();
        const GroupOf<V> group(source, places);
        const V fx = right32<17>(V::load(places.fx)), fy = right32<17>(V::load(places.fy));
        V tap[4], row[4];
        for (int k = 0; k < 4; ++k) {
            tap[k] = shuffled(V::gather8(group.address[k], source.step), V::repeated(order.lane()));
        }
        all = tap[0] & tap[1] & tap[2] & tap[3];
        row[0] = between_rows(tap[0], word<V, 0, 0>(fy));
        row[1] = between_rows(tap[1], word<V, 1, 1>(fy));
        row[2] = between_rows(tap[2], word<V, 2, 2>(fy));
        row[3] = between_rows(tap[3], word<V, 3, 3>(fy));
        return bytes_of(between_columns(row[0], row[1], word<V, 0, 1>(fx)),
                        between_columns(row[2], row[3], word<V, 2, 3>(fx)));
    }

    // Four times the word of one dword, then four times of another.
    template <class V, int Low, int High>
    static V word(V dwords) {
        constexpr LaneOrder order = word_of_dword(Low, High);
        return shuffled(dwords, V::repeated(order.lane()));
    }
};

// Filters of N x N weights.
template <int N>
struct LaneWeighted {
    static constexpr Interpolation interpolation = N == 4 ? Interpolation::bicubic : Interpolation::lanczos3;
    static constexpr int weights_a_phase = N == 4 ? 4 : 8;
    template <int C>
    static constexpr int bytes_loaded = N == 4 ? 16 : 4 * C + 16;

    template <int C>
    static constexpr LaneOrder mask() {
        return all_but_alpha<C>(4);
    }
    template <int C>
    static constexpr LaneOrder mask_of_rest() {
        return all_but_alpha<C>(N - 4);
    }

    // Per lane the weights of a pixel's phase.
    template <class V>
    struct Weights {
        const std::int16_t* address[V::lanes];
        V pair(int first) const { return V::gather_pair(address, first); }
    };

    // The channels of a pixel of each lane as dwords, before they are clamped.
    template <class V, int C>
    static V pixel(const std::uint8_t* const* address, std::size_t step, const Weights<V>& x, const Weights<V>& y,
                   V& all) {
        constexpr LaneOrder pairs01 = pixel_pairs<C>(0), pairs23 = pixel_pairs<C>(2), rest = mask_of_rest<C>();
        const V x01 = x.pair(0), x23 = x.pair(2), x45 = N == 6 ? x.pair(4) : x01;
        const auto along_row = [&](int row) {
            const std::size_t offset = static_cast<std::size_t>(row) * step;
            const V bytes = V::gather16(address, offset);
            all = all & bytes;
            V sum = add32(sums_of_word_pairs(shuffled(bytes, V::repeated(pairs01.lane())), x01),
                          sums_of_word_pairs(shuffled(bytes, V::repeated(pairs23.lane())), x23));
            if (N == 6) {
                const V others = V::gather16(address, offset + 4 * C);
                if (C % 2 == 0) all = all & (others | V::repeated(rest.lane()));
                sum = add32(sum, sums_of_word_pairs(shuffled(others, V::repeated(pairs01.lane())), x45));
            }
            return sum;
        };
        V total = V::repeated(_mm_set1_epi32((1 << 19) + (1 << 13)));
        for (int row = 0; row < N; row += 2) {
            const V first = along_row(row), second = along_row(row + 1);
            const V both = with_odd_words(right32<8>(first), left32<8>(second));
            total = add32(total, sums_of_word_pairs(both, y.pair(row)));
        }
        return signed_right32<20>(total);
    }

    template <class V, int C>
    static V group(const Source& source, const Places& places, V& all) {
        const GroupOf<V> group(source, places);
        std::uint32_t phase_x[GroupOf<V>::size], phase_y[GroupOf<V>::size];
        nearest_phases(V::load(places.fx)).store(phase_x);
        nearest_phases(V::load(places.fy)).store(phase_y);
        const std::int16_t* table = N == 4 ? cubic_weights_q14() : lanczos_weights_q14();
        all = V::repeated(_mm_set1_epi32(-1));
        V pixels[4];
        for (int k = 0; k < 4; ++k) {
            Weights<V> x, y;
            for (int lane = 0; lane < V::lanes; ++lane) {
                x.address[lane] = table + weights_a_phase * phase_x[k + 4 * lane];
                y.address[lane] = table + weights_a_phase * phase_y[k + 4 * lane];
            }
            pixels[k] = pixel<V, C>(group.address[k], source.step, x, y, all);
        }
        return bytes_of(words_of(pixels[0], pixels[1]), words_of(pixels[2], pixels[3]));
    }

    template <class V>
    static V nearest_phases(V fractions) {
        return right32<1>(add32(right32<21>(fractions), V::repeated(_mm_set1_epi32(1))));
    }
};

template <class V, class Filter, int C>
void sample_lanes(const Source& source, const Places& places, int count, void* out) {
    constexpr LaneOrder mask = Filter::template mask<C>(), pack_all = packing(C), pack_more = packing(C + 1);
    constexpr LaneOrder full = lane_order([](int i) { return i % 4 == C ? -1 : 0; });
    const V order = V::repeated(source.adds_alpha ? pack_more.lane() : pack_all.lane());
    const V added = V::repeated(source.adds_alpha ? full.lane() : _mm_setzero_si128());
    const TranslucentSampler replace = C % 2 == 0 ? translucent_sampler(C, Filter::interpolation) : nullptr;
    const std::size_t bytes_a_lane = 4 * static_cast<std::size_t>(C + source.adds_alpha);
    auto* pixel = static_cast<std::uint8_t*>(out);
    for (int i = 0; i < count; i += GroupOf<V>::size) {
        const Places some = places + i;
        V all;
        const V packed = shuffled(Filter::template group<V, C>(source, some, all) | added, order);
        for (int lane = 0; lane < V::lanes; ++lane) {
            _mm_storeu_si128(reinterpret_cast<__m128i*>(pixel + static_cast<std::size_t>(lane) * bytes_a_lane),
                             packed.lane(lane));
        }
        if (C % 2 == 0 && !all_ones(all | V::repeated(mask.lane()))) {
            const int left = count - i;
            replace(source, some, left < GroupOf<V>::size ? left : GroupOf<V>::size, pixel);
        }
        pixel += V::lanes * bytes_a_lane;
    }
}

template <class V, int C>
void accelerate_filter(Interpolation interpolation, Sampler& sampler) {
    switch (interpolation) {
        case Interpolation::nearest: break;
        case Interpolation::bilinear:
            sampler.sample = sample_lanes<V, LaneBilinear, C>;
            sampler.bytes_loaded = LaneBilinear::bytes_loaded<C>;
            break;
        case Interpolation::bicubic:
            sampler.sample = sample_lanes<V, LaneWeighted<4>, C>;
            sampler.bytes_loaded = LaneWeighted<4>::bytes_loaded<C>;
            break;
        case Interpolation::lanczos3:
            sampler.sample = sample_lanes<V, LaneWeighted<6>, C>;
            sampler.bytes_loaded = LaneWeighted<6>::bytes_loaded<C>;
            break;
    }
}

template <class V>
void accelerate_bytes(int channels, Interpolation interpolation, Sampler& sampler) {
    switch (channels) {
        case 1: accelerate_filter<V, 1>(interpolation, sampler); break;
        case 2: accelerate_filter<V, 2>(interpolation, sampler); break;
        case 3: accelerate_filter<V, 3>(interpolation, sampler); break;
        default: accelerate_filter<V, 4>(interpolation, sampler); break;
    }
}

}  // namespace

}  // namespace puppetwarp::detail
