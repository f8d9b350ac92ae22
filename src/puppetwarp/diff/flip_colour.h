#pragma once

#include <puppetwarp/diff/fast_math.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace puppetwarp {

// The colours of FLIP (Andersson et al. 2020), one pixel at a time and inline: loops over rows do four at once.

//! One colour in some space.
struct Colour {
    float a = 0, b = 0, c = 0;
};

namespace flip_constants {

// CIE XYZ of linear sRGB, each row divided by the white (D65), so that white is 1, 1, 1; and the inverse.
inline constexpr double kWhiteX = 0.9504285453, kWhiteZ = 1.0889003707;
inline constexpr float kX[3]{static_cast<float>(0.4123865633 / kWhiteX), static_cast<float>(0.3575914909 / kWhiteX),
                             static_cast<float>(0.1804504912 / kWhiteX)};
inline constexpr float kY[3]{0.2126368217F, 0.7151829818F, 0.07218019648F};
inline constexpr float kZ[3]{static_cast<float>(0.01933062015 / kWhiteZ), static_cast<float>(0.1191971636 / kWhiteZ),
                             static_cast<float>(0.9503725870 / kWhiteZ)};
inline constexpr float kRed[3]{static_cast<float>(3.241003275 * kWhiteX), -1.537398934F,
                               static_cast<float>(-0.498615861 * kWhiteZ)};
inline constexpr float kGreen[3]{static_cast<float>(-0.969224334 * kWhiteX), 1.875930071F,
                                 static_cast<float>(0.041554224 * kWhiteZ)};
inline constexpr float kBlue[3]{static_cast<float>(0.055639423 * kWhiteX), -0.204011202F,
                                static_cast<float>(1.057148933 * kWhiteZ)};

}  // namespace flip_constants

inline Colour xyz_from_linear(const Colour& rgb) {
    using namespace flip_constants;
    return {kX[0] * rgb.a + kX[1] * rgb.b + kX[2] * rgb.c, kY[0] * rgb.a + kY[1] * rgb.b + kY[2] * rgb.c,
            kZ[0] * rgb.a + kZ[1] * rgb.b + kZ[2] * rgb.c};
}

//! The linear opponent space, of linear sRGB: achromatic, red-green, blue-yellow.
inline Colour ycxcz_from_linear(const Colour& rgb) {
    const Colour xyz = xyz_from_linear(rgb);
    return {116 * xyz.b - 16, 500 * (xyz.a - xyz.b), 200 * (xyz.b - xyz.c)};
}

inline float within_display(float value) {
    return value < 0 ? 0.0F : value > 1 ? 1.0F : value;
}

//! Back, cut off to what a display can show.
inline Colour linear_from_ycxcz(const Colour& ycxcz) {
    using namespace flip_constants;
    const float y = (ycxcz.a + 16) * (1 / 116.0F);
    const float x = y + ycxcz.b * (1 / 500.0F), z = y - ycxcz.c * (1 / 200.0F);
    return {within_display(kRed[0] * x + kRed[1] * y + kRed[2] * z),
            within_display(kGreen[0] * x + kGreen[1] * y + kGreen[2] * z),
            within_display(kBlue[0] * x + kBlue[1] * y + kBlue[2] * z)};
}

//! CIELAB's cube root with a straight line near 0.
inline float lab_root(float value) {
    constexpr float cube = 216 / 24389.0F;  // (6 / 29)^3
    const float root = fast_exp2(fast_log2(value > cube ? value : cube) * (1 / 3.0F));
    const float line = value * (841 / 108.0F) + 4 / 29.0F;
    return value > cube ? root : line;
}

//! CIELAB with its chromatic axes scaled by L / 100, after Hunt: saturation is seen less where it is dark.
inline Colour hunt_lab_from_linear(const Colour& rgb) {
    const Colour xyz = xyz_from_linear(rgb);
    const float x = lab_root(xyz.a), y = lab_root(xyz.b), z = lab_root(xyz.c);
    const float lightness = 116 * y - 16;
    const float scale = 0.01F * lightness;
    return {lightness, scale * (500 * (x - y)), scale * (200 * (y - z))};
}

//! The HyAB distance: what lightness differs by plus how far the chromaticities are apart.
inline float hyab(const Colour& p, const Colour& q) {
    const float b = p.b - q.b, c = p.c - q.c;
    return std::abs(p.a - q.a) + std::sqrt(b * b + c * c);
}

//! The colour error, 0 to 1, of HyAB distances (section 4.1.3 of the paper): of their power 0.7, what is below 0.4 of
//! the largest possible is spread over 0 to 0.95, the rest over what is left.
class ColourError {
public:
    ColourError()
        : largest_(fast_pow(hyab(hunt_lab_from_linear({0, 1, 0}), hunt_lab_from_linear({0, 0, 1})), kPower)),
          knee_(kKnee * largest_),
          below_(kAtKnee / knee_),
          above_((1 - kAtKnee) / (largest_ - knee_)) {}

    float of(float distance) const {
        const float error = fast_pow(distance, kPower);
        const float low = below_ * error, high = kAtKnee + (error - knee_) * above_;
        return error < knee_ ? low : high;
    }
    //! The largest distance, between green and blue, to the power 0.7.
    float largest() const { return largest_; }

private:
    static constexpr float kPower = 0.7F, kKnee = 0.4F, kAtKnee = 0.95F;
    float largest_, knee_, below_, above_;
};

//! The error of FLIP (section 4.3): the colour error to the power of 1 - the feature error.
//! \param edges, points  by how much the strengths of edges and of points differ, 0 to the square root of 2.
inline float flip_error(float colour_error, float edges, float points) {
    const float feature_error = std::sqrt((edges > points ? edges : points) * 0.707106781F);
    const float error = fast_pow(colour_error, 1 - feature_error);
    return error < 1 ? error : 1.0F;
}

//! Linear values of sRGB ones, 0 to 1 (IEC 61966-2-1): straight lines between so many exact values that what they miss
//! is below a float's last digits.
class LinearLight {
public:
    LinearLight();
    float of(float encoded) const {
        const float place = encoded * kSteps;
        const int step = std::min(static_cast<int>(place), kSteps - 1);
        const float* value = values_.data() + step;
        return value[0] + (place - static_cast<float>(step)) * (value[1] - value[0]);
    }

private:
    static constexpr int kSteps = 4096;
    std::vector<float> values_;
};

}  // namespace puppetwarp
