#include "canvas.h"
#include "noise.h"
#include "samples.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace samples {

namespace {

const cv::Size kSize(720, 960);
const Vec kCrown(360, 330);  // the middle of the bell's lower rim

const cv::Vec3f kRose = rgb(0xf08fc0), kViolet = rgb(0x7d5bd6), kBlue = rgb(0x5fb4f0), kGlow = rgb(0xfff0ff);

float rim_y(Vec p) {
    const float across = (p.x - kCrown.x) / 235;
    return kCrown.y + 26 * (1 - across * across) + 9 * std::cos(across * 17);
}

float bell_shape(Vec p) {
    return std::max(ellipse(p, kCrown, {240, 255}), p.y - rim_y(p));
}

// Glass-like: thin where one looks straight through, dense towards the edge.
float bell_density(Vec p) {
    const float shape = bell_shape(p);
    const float inside = smooth_step(3, -5, shape);
    const float edge = std::exp(-std::max(-shape, 0.0F) / 26);
    const Vec d = p - Vec(kCrown.x, kCrown.y - 250);
    const float ribs = 0.5F + 0.5F * std::cos(std::atan2(d.x, d.y + 60) * 34);
    const float low = smooth_step(-230, 10, p.y - kCrown.y);
    return inside *
           std::clamp(0.30F + 0.5F * edge + 0.16F * ribs * low + 0.06F * fractal_noise(p * 0.02F, 3, 120), 0.0F, 1.0F);
}

cv::Vec3f bell_colour(Vec p) {
    const float height = std::clamp((kCrown.y - p.y) / 255, 0.0F, 1.0F);
    cv::Vec3f colour = mix(kRose, kViolet, smooth_step(0.05F, 0.75F, height));
    const float lamp = smooth_step(170, 0, length(p - Vec(285, 165)));
    const float edge = smooth_step(26, 0, -bell_shape(p));
    colour = mix(colour, kGlow, 0.7F * lamp * lamp);
    return mix(colour, rgb(0xd8c8ff), 0.6F * edge);
}

Curve tentacle(int index, int count) {
    const float share = (static_cast<float>(index) + 0.5F) / static_cast<float>(count) * 2 - 1;
    const float reach = 430 + 150 * random_at(index, 0, 121), phase = 6.3F * random_at(index, 1, 121);
    std::vector<CurvePoint> knots;
    for (int i = 0; i <= 9; ++i) {
        const float t = static_cast<float>(i) / 9;
        const float sway = (10 + 26 * t) * std::sin(phase + 5.5F * t) + 40 * t * share;
        knots.push_back({{kCrown.x + 205 * share + sway, kCrown.y - 34 + reach * t}, mix(5.0F, 1.6F, t)});
    }
    return smooth_curve(knots, 8);
}

void lay_tentacles(Canvas& canvas) {
    constexpr int kCount = 11;
    for (int i = 0; i < kCount; ++i) {
        const Curve curve = tentacle(i, kCount);
        const Field cover = field(kSize, [&](Vec p) {
            if (p.y < kCrown.y - 60) return 0.0F;
            const CurvePlace place = nearest_on_curve(p, curve);
            const float thread = smooth_step(1.2F, -2.2F, place.distance),
                        glow = std::exp(-std::max(place.distance, 0.0F) / 3.5F);
            const float fading = smooth_step(620, 300, place.along);
            return std::max(0.75F * thread, 0.22F * glow * smooth_step(18, 8, place.distance)) * mix(0.55F, 1, fading);
        });
        canvas.lay(mix(kRose, kBlue, random_at(i, 2, 121)), cover);
    }
}

// Frilled ribbons from under the bell.
void lay_arms(Canvas& canvas) {
    for (int i = 0; i < 4; ++i) {
        const float side = static_cast<float>(i) - 1.5F;
        const Curve curve = smooth_curve({{{360 + side * 34, 300}, 17},
                                          {{360 + side * 44, 420}, 25},
                                          {{360 + side * 40 + 16 * std::sin(side * 2), 540}, 22},
                                          {{360 + side * 54, 650}, 15},
                                          {{360 + side * 50 - 12 * std::sin(side * 3), 750}, 5}});
        const auto frill = [&](Vec p) {
            const CurvePlace place = nearest_on_curve(p, curve);
            return place.distance + 5 * std::sin(place.along * 0.16F + side) * std::min(std::abs(place.across), 1.3F) +
                   3 * smooth_noise(p * 0.06F, 122);
        };
        const Field cover = field(kSize, [&](Vec p) {
            const float distance = frill(p);
            const float folds = 0.5F + 0.5F * fractal_noise({p.x * 0.09F, p.y * 0.03F}, 3, 123);
            return smooth_step(3, -9, distance) *
                   (0.34F + 0.3F * folds + 0.3F * std::exp(-std::max(-distance, 0.0F) / 6));
        });
        const Paint colour = paint(
            kSize, [](Vec p) { return mix(mix(kGlow, kRose, 0.55F), kViolet, smooth_step(430, 800, p.y) * 0.7F); });
        canvas.lay(colour, cover);
    }
}

void lay_bell(Canvas& canvas) {
    // Four horseshoes shine through the bell, as in a moon jelly.
    const Field marks = field(kSize, [](Vec p) {
        float nearest = 100;
        for (float side : {-1.0F, 1.0F}) {
            nearest = std::min(nearest, std::abs(ellipse(p, {kCrown.x + side * 52, 205}, {36, 27}, side * 20)) - 8);
            nearest = std::min(nearest, std::abs(ellipse(p, {kCrown.x + side * 104, 245}, {30, 22}, side * 40)) - 6);
        }
        return smooth_step(9, -7, nearest) * 0.6F;
    });
    canvas.lay(mix(kRose, kGlow, 0.35F), marks);
    canvas.lay(paint(kSize, bell_colour), field(kSize, bell_density));
    const Field gleam = field(kSize, [](Vec p) {
        const float arc = std::abs(ellipse(p, {kCrown.x, kCrown.y}, {205, 218})) - 7;
        return smooth_step(10, -8, arc) * smooth_step(330, 230, p.x) * smooth_step(270, 200, p.y) *
               smooth_step(140, 190, p.x);
    });
    canvas.lay(kGlow, gleam * 0.75F);
}

// As many levels as a camera tells apart; the noise of the lower bits would double the file.
puppetwarp::Image with_twelve_bits(puppetwarp::Image image) {
    for (int y = 0; y < image.height(); ++y) {
        auto* row = image.pixels.ptr<std::uint16_t>(y);
        for (int i = 0; i < image.width() * 4; ++i)
            row[i] = static_cast<std::uint16_t>((row[i] & 0xfff0) | (row[i] >> 12));
    }
    return image;
}

}  // namespace

puppetwarp::Image draw_jellyfish() {
    Canvas canvas(kSize);
    // A halo of its own light: alpha from a trace upwards.
    canvas.lay(kViolet, field(kSize, [](Vec p) {
                   const float distance = std::max(bell_shape(p), 0.0F);
                   return 0.20F * std::exp(-distance / 14) * smooth_step(44, 20, distance);
               }));
    lay_tentacles(canvas);
    lay_arms(canvas);
    lay_bell(canvas);
    return with_twelve_bits(canvas.image(CV_16U, true));
}

}  // namespace samples
