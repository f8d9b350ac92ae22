#include <puppetwarp/image/tone_curves.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace puppetwarp {

namespace {

// Big-endian numbers of a profile; what lies behind its end reads as 0.
class ProfileBytes {
public:
    explicit ProfileBytes(const std::vector<std::uint8_t>& bytes) : bytes_(bytes) {}

    std::uint32_t u32(std::size_t at) const { return (u16(at) << 16) | u16(at + 2); }
    std::uint32_t u16(std::size_t at) const {
        return at + 1 < bytes_.size() ? static_cast<std::uint32_t>(bytes_[at] << 8 | bytes_[at + 1]) : 0;
    }
    double s15_fixed16(std::size_t at) const { return static_cast<std::int32_t>(u32(at)) / 65536.0; }
    bool is(std::size_t at, std::string_view signature) const {
        return at + 4 <= bytes_.size() && std::equal(signature.begin(), signature.end(), bytes_.begin() + at);
    }
    bool holds(std::size_t at, std::size_t size) const { return at <= bytes_.size() && size <= bytes_.size() - at; }

    // Where a tag's data begin.
    std::optional<std::size_t> tag(std::string_view signature) const {
        const std::size_t count = std::min<std::size_t>(u32(128), bytes_.size() / 12);
        for (std::size_t i = 0; i < count; ++i) {
            if (is(132 + 12 * i, signature)) return u32(136 + 12 * i);
        }
        return std::nullopt;
    }

private:
    const std::vector<std::uint8_t>& bytes_;
};

double power(double base, double exponent) {
    return base <= 0 ? 0 : std::pow(base, exponent);
}

ToneCurve gamma_curve(double gamma) {
    return [gamma](double x) { return power(x, gamma); };
}

ToneCurve table_curve(std::vector<double> values) {
    return [values = std::move(values)](double x) {
        const double at = std::clamp(x, 0.0, 1.0) * static_cast<double>(values.size() - 1);
        const auto before = std::min(static_cast<std::size_t>(at), values.size() - 2);
        return values[before] + (values[before + 1] - values[before]) * (at - static_cast<double>(before));
    };
}

// curveType
std::optional<ToneCurve> read_curve(const ProfileBytes& profile, std::size_t at) {
    const std::size_t count = profile.u32(at + 8);
    if (count == 0) return gamma_curve(1);
    if (!profile.holds(at + 12, 2 * std::min<std::size_t>(count, 1U << 20))) return std::nullopt;
    if (count == 1) return gamma_curve(profile.u16(at + 12) / 256.0);
    if (count > 65536) return std::nullopt;
    std::vector<double> values(count);
    for (std::size_t i = 0; i < count; ++i) values[i] = profile.u16(at + 12 + 2 * i) / 65535.0;
    return table_curve(std::move(values));
}

// parametricCurveType: (a x + b)^g + e from d on, c x + f below. The first types have some of these only.
std::optional<ToneCurve> read_parametric(const ProfileBytes& profile, std::size_t at) {
    const std::uint32_t type = profile.u16(at + 8);
    constexpr std::array<std::size_t, 5> parameters{1, 3, 4, 5, 7};
    if (type >= parameters.size() || !profile.holds(at + 12, 4 * parameters[type])) return std::nullopt;
    const auto parameter = [&](std::size_t i) { return profile.s15_fixed16(at + 12 + 4 * i); };
    const double g = parameter(0);
    if (type == 0) return gamma_curve(g);
    const double a = parameter(1), b = parameter(2);
    if (type <= 2) {
        const double low = type == 2 ? parameter(3) : 0;
        return [=](double x) { return power(a * x + b, g) + low; };
    }
    const double c = parameter(3), d = parameter(4);
    const double e = type == 4 ? parameter(5) : 0, f = type == 4 ? parameter(6) : 0;
    return [=](double x) { return x >= d ? power(a * x + b, g) + e : c * x + f; };
}

std::optional<ToneCurve> read_tone(const ProfileBytes& profile, std::string_view signature) {
    const std::optional<std::size_t> at = profile.tag(signature);
    if (!at) return std::nullopt;
    if (profile.is(*at, "curv")) return read_curve(profile, *at);
    if (profile.is(*at, "para")) return read_parametric(profile, *at);
    return std::nullopt;
}

}  // namespace

double srgb_light(double encoded) {
    return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

std::vector<ToneCurve> tone_curves(const Image& image) {
    const ProfileBytes profile(image.metadata.icc);
    if (image.pixels.channels() <= 2) return {read_tone(profile, "kTRC").value_or(srgb_light)};
    std::vector<ToneCurve> curves;
    for (const std::string_view signature : {"rTRC", "gTRC", "bTRC"}) {
        std::optional<ToneCurve> curve = read_tone(profile, signature);
        if (!curve) return {srgb_light};
        curves.push_back(std::move(*curve));
    }
    const bool shared = profile.tag("rTRC") == profile.tag("gTRC") && profile.tag("rTRC") == profile.tag("bTRC");
    if (shared) curves.resize(1);
    return curves;
}

}  // namespace puppetwarp
