#pragma once

#include <puppetwarp/warp/filter_tables.h>
#include <puppetwarp/warp/lane_vectors.h>
#include <puppetwarp/warp/sampling.h>

// 8-bit filters, a pixel a 128-bit lane and four vectors at a time. Internal linkage for the reason given in
// lane_vectors.h. The first vector of two lanes holds pixels 0 and 4, the next 1 and 5: so the pixels are in order when
// they are packed, without a shuffle across lanes.
namespace puppetwarp::detail {

namespace {

constexpr int no_byte = -1;

// From bytes of neighbouring pixels to pairs of words: channel c of pixels `left` and `left + 1`.
template <int C>
constexpr LaneBytes pixel_pairs(int left) {
    return lane_bytes([left](int i) {
        const int c = i / 4;
        return i % 2 == 1 || c >= C ? no_byte : C * (left + i / 2 % 2) + c;
    });
}

// Four pixels of 4 bytes to four of `channels`.
constexpr LaneBytes packing(int channels) {
    return lane_bytes([channels](int i) { return i >= 4 * channels ? no_byte : i / channels * 4 + i % channels; });
}

// All ones but for the alpha of `pixels` pixels side by side.
template <int C>
constexpr LaneBytes all_but_alpha(int pixels) {
    return lane_bytes([pixels](int i) { return i % C == C - 1 && i / C < pixels ? 0 : -1; });
}

constexpr LaneBytes word_of_dword(int low, int high) {
    return lane_bytes([=](int i) { return 4 * (i < 8 ? low : high) + i % 2; });
}

// Pixels that four vectors hold.
template <class V>
constexpr int group_size = 4 * V::lanes;

struct LaneBilinear {
    static constexpr Interpolation interpolation = Interpolation::bilinear;
    static const std::int16_t* weights() { return nullptr; }
    template <int C>
    static constexpr int bytes_loaded = 8;

    // Pairs of bytes, upper and lower: the left pixel's channels, then the right one's.
    template <int C>
    static constexpr LaneBytes corners() {
        return lane_bytes([](int i) {
            const int c = i / 2 % 4;
            return c >= C ? no_byte : 8 * (i % 2) + C * (i / 8) + c;
        });
    }

    // Ones but for alpha, in that order.
    template <int C>
    static constexpr LaneBytes mask() {
        return lane_bytes([](int i) { return i / 2 % 4 == C - 1 ? 0 : -1; });
    }

    // The words of a pixel's left and right column, between the rows, Q6.
    template <class V>
    static V between_rows(V corners, V fy) {
        const V upper = sums_of_byte_pairs(corners, V::words(64));
        const V difference = sums_of_byte_pairs(corners, V::words((64 << 8) | (256 - 64)));
        return add16(upper, times_q15(difference, fy));
    }

    // Two vectors of pixels.
    template <class V>
    static V between_columns(V p, V q, V fx) {
        const V left = low_halves(p, q);
        const V value = add16(left, times_q15(sub16(high_halves(p, q), left), fx));
        return right16<6>(add16(value, V::words(32)));
    }

    // A group of pixels, 4 bytes each. \param all  gets the bits that all taps have.
    template <class V, int C>
    static V group(const Source& source, const std::int16_t*, const Places& places, V& all) {
        constexpr LaneBytes order = corners<C>();
        const std::uint8_t *upper = source.data, *lower = upper + source.step;
        const V fx = right32<17>(V::load(places.fx)), fy = right32<17>(V::load(places.fy));
        V tap[4], row[4];
        for (int k = 0; k < 4; ++k) {
            tap[k] = shuffled(V::gather8(upper, lower, places.first + k), V::of(order));
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
        constexpr LaneBytes order = word_of_dword(Low, High);
        return shuffled(dwords, V::of(order));
    }
};

// Filters of N x N weights.
template <int N>
struct LaneWeighted {
    static constexpr Interpolation interpolation = N == 4 ? Interpolation::bicubic : Interpolation::lanczos3;
    static const std::int16_t* weights() { return N == 4 ? cubic_weights_q14() : lanczos_weights_q14(); }
    template <int C>
    static constexpr int bytes_loaded = N == 4 ? 16 : 4 * C + 16;

    template <int C>
    static constexpr LaneBytes mask() {
        return all_but_alpha<C>(4);
    }
    template <int C>
    static constexpr LaneBytes mask_of_rest() {
        return all_but_alpha<C>(N - 4);
    }

    // The channels of a pixel of each lane as dwords, before they are clamped.
    // \param first  places of the first taps; \param wx,wy of their weights.
    template <class V, int C>
    static V pixel(const Source& source, const std::int16_t* table, const std::uint32_t* first, const std::uint32_t* wx,
                   const std::uint32_t* wy, V& all) {
        constexpr LaneBytes pairs01 = pixel_pairs<C>(0), pairs23 = pixel_pairs<C>(2), rest = mask_of_rest<C>();
        const V x01 = V::gather_pair(table, wx), x23 = V::gather_pair(table + 2, wx);
        const V x45 = N == 6 ? V::gather_pair(table + 4, wx) : x01;
        const auto along_row = [&](int row) {
            const std::uint8_t* data = source.data + static_cast<std::size_t>(row) * source.step;
            const V bytes = V::gather16(data, first);
            all = all & bytes;
            V sum = add32(sums_of_word_pairs(shuffled(bytes, V::of(pairs01)), x01),
                          sums_of_word_pairs(shuffled(bytes, V::of(pairs23)), x23));
            if (N == 6) {
                const V others = V::gather16(data + 4 * C, first);
                if (C % 2 == 0) all = all & (others | V::of(rest));
                sum = add32(sum, sums_of_word_pairs(shuffled(others, V::of(pairs01)), x45));
            }
            return sum;
        };
        V total = V::dwords((1 << 19) + (1 << 13));
        for (int row = 0; row < N; row += 2) {
            const V upper = along_row(row), lower = along_row(row + 1);
            const V both = with_odd_words(right32<8>(upper), left32<8>(lower));
            total = add32(total, sums_of_word_pairs(both, V::gather_pair(table + row, wy)));
        }
        return signed_right32<20>(total);
    }

    template <class V, int C>
    static V group(const Source& source, const std::int16_t* table, const Places& places, V& all) {
        std::uint32_t wx[group_size<V>], wy[group_size<V>];
        places_of_weights(V::load(places.fx)).store(wx);
        places_of_weights(V::load(places.fy)).store(wy);
        all = V::dwords(-1);
        V pixels[4];
        for (int k = 0; k < 4; ++k) pixels[k] = pixel<V, C>(source, table, places.first + k, wx + k, wy + k, all);
        return bytes_of(words_of(pixels[0], pixels[1]), words_of(pixels[2], pixels[3]));
    }

    // Where the weights of the nearest phases stand in the table.
    template <class V>
    static V places_of_weights(V fractions) {
        const V phases = right32<1>(add32(right32<21>(fractions), V::dwords(1)));
        return left32 < N == 4 ? 2 : 3 > (phases);
    }
};

// Up to 64 groups of pixels. \return a bit for each of them: whether some tap is translucent.
template <class V, class Filter, int C>
std::uint64_t sample_groups(const Source& source, const Places& places, int groups, std::uint8_t* out) {
    constexpr LaneBytes mask = Filter::template mask<C>(), pack_all = packing(C), pack_more = packing(C + 1);
    constexpr LaneBytes full = lane_bytes([](int i) { return i % 4 == C ? -1 : 0; }), none{};
    const V order = V::of(source.adds_alpha ? pack_more : pack_all);
    const V added = V::of(source.adds_alpha ? full : none);
    const std::int16_t* table = Filter::weights();
    const std::size_t bytes_a_lane = 4 * static_cast<std::size_t>(C + source.adds_alpha);
    std::uint64_t translucent = 0;
    for (int i = 0; i < groups; ++i) {
        V all;
        const V pixels = Filter::template group<V, C>(source, table, places + i * group_size<V>, all);
        const V packed = shuffled(pixels | added, order);
        for (int lane = 0; lane < V::lanes; ++lane, out += bytes_a_lane) {
            _mm_storeu_si128(reinterpret_cast<__m128i*>(out), packed.lane(lane));
        }
        // Without a branch, which would take a third of the time.
        if (C % 2 == 0) translucent |= std::uint64_t{!all_ones(all | V::of(mask))} << i;
    }
    return translucent;
}

using Blend = void (*)(const Source& source, const Places& places, int count, void* samples);

// What blends translucent taps with vectors V, where that is not portable code.
template <class V>
struct BlendOf {
    template <int C>
    static Blend filter(Interpolation) {
        return nullptr;
    }
};

// Sampled pixels in groups whose taps are not all opaque.
template <class V, class Filter, int C>
void replace_translucent(const Source& source, const Places& places, int count, std::uint64_t groups,
                         std::uint8_t* out) {
    TranslucentPixels translucent = translucent_pixels(C, Filter::interpolation);
    if (const Blend blend = BlendOf<V>::template filter<C>(Filter::interpolation)) translucent.blend = blend;
    alignas(32) float samples[4 * (group_size<V> + places_padding)];
    for (; groups != 0; groups &= groups - 1) {
        const int first = __builtin_ctzll(groups) * group_size<V>;
        const int length = count - first < group_size<V> ? count - first : group_size<V>;
        translucent.blend(source, places + first, length, samples);
        translucent.replace(source, places + first, length, samples, out + C * first);
    }
}

template <class V, class Filter, int C>
void sample_lanes(const Source& source, const Places& places, int count, void* out) {
    constexpr int chunk = 64 * group_size<V>;
    const int out_channels = C + source.adds_alpha;
    for (int done = 0; done < count; done += chunk) {
        const int left = count - done < chunk ? count - done : chunk;
        std::uint8_t* pixels = static_cast<std::uint8_t*>(out) + out_channels * done;
        const int groups = (left + group_size<V> - 1) / group_size<V>;
        const std::uint64_t translucent = sample_groups<V, Filter, C>(source, places + done, groups, pixels);
        if (C % 2 == 0) replace_translucent<V, Filter, C>(source, places + done, left, translucent, pixels);
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
