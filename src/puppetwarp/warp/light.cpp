#include <puppetwarp/warp/light.h>

#include <puppetwarp/image/tone_curves.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace puppetwarp::detail {

namespace {

constexpr int bucket_count = 65536;

}  // namespace

LightTables::LightTables(const Image& image)
    : full_(static_cast<float>(image.full_value())), buckets_a_unit_((bucket_count - 1) / full_) {
    const auto full = static_cast<std::size_t>(image.full_value());
    for (const ToneCurve& tone : tone_curves(image)) {
        Curve curve;
        // Lights and limits take turns. Where the profile's curve does not rise, the next number does.
        float last = -std::numeric_limits<float>::min();
        const auto next = [&](double value) {
            const auto light = static_cast<float>(std::clamp(tone(value / image.full_value()), 0.0, 1.0) * full_);
            const float least = std::nextafter(last, std::numeric_limits<float>::max());
            last = light > least ? light : least;
            return last;
        };
        for (std::size_t i = 0; i <= full; ++i) {
            curve.light.push_back(next(static_cast<double>(i)));
            if (i < full) curve.limits.push_back(next(static_cast<double>(i) + 0.5));
        }
        for (int bucket = 0; bucket <= bucket_count; ++bucket) {
            const auto below = std::upper_bound(curve.limits.begin(), curve.limits.end(),
                                                static_cast<float>(bucket) / buckets_a_unit_);
            curve.buckets.push_back(static_cast<std::uint16_t>(below - curve.limits.begin()));
        }
        curve.buckets.back() = static_cast<std::uint16_t>(full);
        curves_.push_back(std::move(curve));
    }
}

int LightTables::encode(int channel, float light) const {
    const Curve& tone = curve(channel);
    const float shown = light > 0 ? std::min(light, full_) : 0;  // not a number: as nothing
    const auto bucket = static_cast<std::size_t>(shown * buckets_a_unit_);
    const float* limits = tone.limits.data();
    // A bucket more on either side: the product was rounded.
    const float* first = limits + tone.buckets[bucket > 0 ? bucket - 1 : 0];
    const float* last = limits + tone.buckets[std::min<std::size_t>(bucket + 2, bucket_count)];
    return static_cast<int>(std::upper_bound(first, last, shown) - limits);
}

}  // namespace puppetwarp::detail
