#include "canvas.h"
#include "noise.h"
#include "samples.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace samples {

namespace {

const cv::Size kSize(1000, 900);
constexpr std::size_t kSteps = 10;  // pieces between two knots

// From the end at the lower left up through the crossing, round the right lobe, the belly, the left lobe and back.
Curve pretzel() {
    std::vector<CurvePoint> half{{{272, 668}, 36}, {{345, 575}, 42}, {{430, 488}, 46}, {{505, 415}, 48},
                                 {{575, 315}, 52}, {{660, 190}, 57}, {{775, 130}, 62}, {{880, 200}, 67},
                                 {{905, 350}, 72}, {{865, 510}, 79}, {{765, 645}, 87}, {{640, 725}, 93}};
    std::vector<CurvePoint> knots = half;
    knots.push_back({{500, 750}, 96});
    for (auto knot = half.rbegin(); knot != half.rend(); ++knot)
        knots.push_back({{1000 - knot->at.x, knot->at.y}, knot->radius});
    return smooth_curve(knots, static_cast<int>(kSteps));
}

cv::Vec3f crust(Vec p, const CurvePlace& place) {
    const float ridge = std::max(0.0F, 1 - place.across * place.across);
    const float patches = fractal_noise(p * 0.013F, 3, 5);
    cv::Vec3f colour = mix(rgb(0xc07a34), rgb(0x84401a), std::clamp(ridge * 1.05F + 0.25F * patches, 0.0F, 1.0F));
    // Fine blisters where the lye dried.
    const float blisters = smooth_step(0.25F, 0.6F, fractal_noise(p * 0.11F, 2, 13));
    return mix(colour, rgb(0xd79a55), 0.16F * blisters) * (1 + 0.04F * fractal_noise(p * 0.06F, 2, 19));
}

// How far the belly's crust has split open, 0 to 1.
float split(Vec p) {
    const float middle = 776 - 0.0009F * (p.x - 500) * (p.x - 500) + 5 * smooth_noise({p.x * 0.03F, 0}, 8);
    const float half = 21 * std::sqrt(std::max(0.0F, 1 - (p.x - 500) * (p.x - 500) / (150.0F * 150)));
    return half == 0 ? 0 : smooth_step(-2, -9, std::abs(p.y - middle) - half + 3.5F * smooth_noise(p * 0.09F, 9));
}

// One stretch of the pretzel, shaded as a whole strand but laid only where `shown` says.
void lay_strand(Canvas& canvas, const Curve& strand, const Field& shown) {
    const Field shape = field(kSize, [&](Vec p) { return tube(p, strand); });
    const Field cover = coverage(shape).mul(shown);
    canvas.lay_inside(rgb(0x2a1005), blurred(moved(cover, {5, 9}), 9).mul(shown) * 0.75F);
    Field height = blurred(field(kSize, [&](Vec p) { return 0.7F * tube_height(nearest_on_curve(p, strand)); }), 3);
    height += field(kSize, [](Vec p) { return 1.1F * fractal_noise(p * 0.07F, 2, 3) - 9 * split(p); });
    const Paint colour = paint(kSize, [&](Vec p) {
        if (cover(cvFloor(p.y), cvFloor(p.x)) == 0) return cv::Vec3f();
        const cv::Vec3f crumb = rgb(0xf0cf94) * (1 + 0.08F * fractal_noise(p * 0.12F, 3, 21));
        return mix(crust(p, nearest_on_curve(p, strand)), crumb, split(p));
    });
    canvas.lay(lit(colour, height, {.contrast = 0.95F, .highlight = 0.55F, .gloss = 30}), cover);
}

std::vector<Vec> salt_places(const Curve& curve) {
    std::vector<Vec> places;
    for (int i = 0; i < 150; ++i) {
        const float share = random_at(i, 0, 51);
        const CurvePoint& point =
            curve.points()[static_cast<std::size_t>(share * static_cast<float>(curve.points().size() - 1))];
        const float aside = (random_at(i, 1, 51) - 0.5F) * 1.5F * point.radius;
        const Vec place = point.at + direction(360 * random_at(i, 2, 51)) * aside;
        const bool free =
            std::none_of(places.begin(), places.end(), [&](Vec other) { return length(place - other) < 19; });
        if (free && split(place) < 0.05F) places.push_back(place);
    }
    return places;
}

float salt_shape(Vec p, const std::vector<Vec>& places) {
    float nearest = 100;
    for (std::size_t i = 0; i < places.size(); ++i) {
        if (length(p - places[i]) > 16) continue;
        const auto seed = static_cast<int>(i);
        const Vec axis = direction(360 * random_at(seed, 3, 52)), d = p - places[i];
        const Vec turned(d.dot(axis), d.dot({-axis.y, axis.x}));
        const Vec half(4.5F + 4 * random_at(seed, 4, 52), 4 + 3 * random_at(seed, 5, 52));
        nearest = std::min(nearest, rounded_box(turned, {0, 0}, half, 2.2F));
    }
    return nearest;
}

void lay_salt(Canvas& canvas, const Curve& curve) {
    const std::vector<Vec> places = salt_places(curve);
    const Field shape = field(kSize, [&](Vec p) { return salt_shape(p, places); });
    const Field cover = coverage(shape);
    canvas.lay_inside(rgb(0x2a1005), blurred(moved(cover, {2, 3}), 2.2F) * 0.75F);
    const Field height =
        blurred(dome(shape, 5, 5), 0.7F) + field(kSize, [](Vec p) { return 1.5F * smooth_noise(p * 0.3F, 61); });
    canvas.lay_inside(lit(Paint(kSize, rgb(0xf3efe8)), height, {.contrast = 0.5F, .highlight = 0.25F, .gloss = 20}),
                      cover * 0.97F);
}

}  // namespace

puppetwarp::Image draw_ring() {
    Canvas canvas(kSize);
    const Curve whole = pretzel();
    const std::size_t last = whole.points().size() - 1;
    const Curve first_end = whole.part(0, 6 * kSteps), last_end = whole.part(last - 6 * kSteps, last);
    const Curve ring = whole.part(3 * kSteps, last - 3 * kSteps);
    const Field everywhere(kSize, 1.0F);
    // The ends start to lie on top above the crossing, where nothing else is near.
    const Field ends = field(kSize, [](Vec p) { return smooth_step(296, 304, p.y); });
    lay_strand(canvas, ring, everywhere);
    lay_strand(canvas, last_end, ends);
    lay_strand(canvas, first_end, ends);
    lay_salt(canvas, whole);
    return canvas.image(CV_8U, true);
}

}  // namespace samples
