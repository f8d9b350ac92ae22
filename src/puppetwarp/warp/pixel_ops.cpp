#include <puppetwarp/warp/pixel_codec.h>
#include <puppetwarp/warp/pixel_ops.h>

#include <cmath>

namespace puppetwarp::detail {

namespace {

template <class T>
T rounded(double value) {
    if constexpr (std::is_floating_point_v<T>) {
        return static_cast<T>(value);
    } else {
        return static_cast<T>(std::clamp(value + 0.5, 0.0, static_cast<double>(std::numeric_limits<T>::max())));
    }
}

template <class T, int C, bool AddsAlpha>
void copy_pixel(const T* from, T* to) {
    std::memcpy(to, from, sizeof(T) * C);
    if constexpr (AddsAlpha) to[C] = Encoded<T, C>::full_value;
}

template <class T, int C, bool AddsAlpha>
void copy(const Source& source, std::int64_t x, std::int64_t y, int count, void* out) {
    constexpr int out_channels = C + AddsAlpha;
    T* to = static_cast<T*>(out);
    const auto row = std::clamp<std::int64_t>(y, 0, source.height - 1);
    const T* from = reinterpret_cast<const T*>(source.data + static_cast<std::size_t>(row) * source.step);
    const auto before = static_cast<int>(std::clamp<std::int64_t>(-x, 0, count));
    const auto end = static_cast<int>(std::clamp<std::int64_t>(source.width - x, before, count));
    const auto outside = [&](int first, int last, int column) {
        for (int i = first; i < last; ++i) copy_pixel<T, C, AddsAlpha>(from + C * column, to + out_channels * i);
    };
    if (Encoded<T, C>::has_alpha) {
        if (row != y) {
            std::fill_n(to, C * count, T{});
            return;
        }
        std::fill_n(to, C * before, T{});
        std::fill_n(to + C * end, C * (count - end), T{});
    } else {
        outside(0, before, 0);
        outside(end, count, source.width - 1);
    }
    if (before == end) return;
    const T* inside = from + C * (x + before);
    if constexpr (!AddsAlpha) {
        std::memcpy(to + C * before, inside, sizeof(T) * static_cast<std::size_t>(C * (end - before)));
    } else {
        for (int i = before; i < end; ++i, inside += C) copy_pixel<T, C, true>(inside, to + out_channels * i);
    }
}

// Eight bytes at a time: this looks at every pixel that is painted. All pixels with alpha have 2, 4, 8 or 16 bytes.
template <class T, int C>
bool any_alpha(const void* pixels, int count) {
    constexpr std::size_t words_a_pixel = (sizeof(T) * C + 7) / 8;
    constexpr std::size_t channels = 8 * words_a_pixel / sizeof(T);
    std::uint64_t mask[words_a_pixel], any[words_a_pixel] = {};
    std::memset(mask, 0, sizeof(mask));
    for (std::size_t i = C - 1; i < channels; i += C) {
        std::memset(reinterpret_cast<unsigned char*>(mask) + i * sizeof(T), 0xff, sizeof(T));
    }
    const auto* bytes = static_cast<const unsigned char*>(pixels);
    const std::size_t size = sizeof(T) * C * static_cast<std::size_t>(count);
    std::size_t i = 0;
    for (; i + sizeof(mask) <= size; i += sizeof(mask)) {
        std::uint64_t words[words_a_pixel];
        std::memcpy(words, bytes + i, sizeof(words));
        for (std::size_t k = 0; k < words_a_pixel; ++k) any[k] |= words[k];
    }
    std::uint64_t tail[words_a_pixel] = {};
    std::memcpy(tail, bytes + i, size - i);
    std::uint64_t found = 0;
    for (std::size_t k = 0; k < words_a_pixel; ++k) found |= (any[k] | tail[k]) & mask[k];
    return found != 0;
}

// As they are stored.
template <class T>
struct AsStored {
    double value(int, T stored) const { return static_cast<double>(stored); }
    T stored(int, double value) const { return rounded<T>(value); }
};

template <class T>
struct AsLight {
    const LightTables& light;
    double value(int channel, T stored) const { return static_cast<double>(light.decode(channel)[stored]); }
    T stored(int channel, double value) const {
        return static_cast<T>(light.encode(channel, static_cast<float>(value)));
    }
};

template <class T, int C, class Colours>
void pixel_over(const Colours& colours, const T* front, T* back) {
    constexpr int alpha = C - 1;
    constexpr double full = Encoded<T, C>::full;
    const double front_alpha = front[alpha], back_alpha = back[alpha];
    if (front_alpha <= 0) return;
    if (front_alpha >= full || back_alpha <= 0) {
        std::copy_n(front, C, back);
        return;
    }
    const double front_weight = front_alpha * full;
    const double back_weight = back_alpha * (full - front_alpha);
    const double weight = front_weight + back_weight;
    for (int c = 0; c < alpha; ++c) {
        const double sum = colours.value(c, front[c]) * front_weight + colours.value(c, back[c]) * back_weight;
        back[c] = colours.stored(c, sum / weight);
    }
    back[alpha] = rounded<T>(weight / full);
}

template <class T, int C>
void over(const LightTables* light, const void* front, void* back, int count) {
    const T* from = static_cast<const T*>(front);
    T* to = static_cast<T*>(back);
    if constexpr (!std::is_floating_point_v<T>) {
        if (light != nullptr) {
            for (int i = 0; i < count; ++i) pixel_over<T, C>(AsLight<T>{*light}, from + C * i, to + C * i);
            return;
        }
    }
    for (int i = 0; i < count; ++i) pixel_over<T, C>(AsStored<T>(), from + C * i, to + C * i);
}

template <class T, int C>
void fade(void* pixel, float coverage) {
    T* p = static_cast<T*>(pixel);
    p[C - 1] = rounded<T>(static_cast<float>(p[C - 1]) * coverage);
    if (p[C - 1] == 0) std::fill_n(p, C, T{});
}

template <class T, int C, bool AddsAlpha>
PixelOps ops() {
    constexpr int out = C + AddsAlpha;
    PixelOps result{copy<T, C, AddsAlpha>, nullptr, nullptr, nullptr};
    if constexpr (out % 2 == 0) {
        result.any_alpha = any_alpha<T, out>;
        result.over = over<T, out>;
        result.fade = fade<T, out>;
    }
    return result;
}

template <class T>
PixelOps ops_of_channels(const PixelFormat& format) {
    switch (format.channels) {
        case 1: return format.adds_alpha ? ops<T, 1, true>() : ops<T, 1, false>();
        case 2: return ops<T, 2, false>();
        case 3: return format.adds_alpha ? ops<T, 3, true>() : ops<T, 3, false>();
        default: return ops<T, 4, false>();
    }
}

}  // namespace

PixelOps find_pixel_ops(const PixelFormat& format) {
    switch (format.depth) {
        case CV_8U: return ops_of_channels<std::uint8_t>(format);
        case CV_16U: return ops_of_channels<std::uint16_t>(format);
        default: return ops_of_channels<float>(format);
    }
}

}  // namespace puppetwarp::detail
