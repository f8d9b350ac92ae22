#include "canvas.h"
#include "noise.h"
#include "samples.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

namespace samples {

namespace {

const cv::Size kSize(1000, 1200);

// A turned piece of wood between two points, its outline given by radii at even steps.
struct Part {
    Vec from, to;
    std::vector<float> radii;
    cv::Vec3f wood;
    cv::Vec3f band;       // painted ring
    float band_from = 2;  // shares of the length; above 1: none
    float band_to = 2;
    float grain = 1;  // how much of the wood shows: less through paint
};

struct Ball {
    Vec at;
    float radius;
};

// Left limbs mirror the right ones about the middle.
Vec mirrored(Vec p) {
    return {1000 - p.x, p.y};
}

Curve outline_of(const Part& part) {
    std::vector<CurvePoint> knots;
    const auto last = static_cast<float>(part.radii.size() - 1);
    for (std::size_t i = 0; i < part.radii.size(); ++i) {
        knots.push_back({part.from + (part.to - part.from) * (static_cast<float>(i) / last), part.radii[i]});
    }
    // Finer, so that the radius bends softly between the knots.
    std::vector<CurvePoint> curve;
    for (std::size_t i = 0; i + 1 < knots.size(); ++i) {
        for (int step = 0; step < 8; ++step) {
            const float t = static_cast<float>(step) / 8, s = smooth_step(0, 1, t);
            curve.push_back({knots[i].at + (knots[i + 1].at - knots[i].at) * t,
                             mix(knots[i].radius, knots[i + 1].radius, mix(t, s, 0.6F))});
        }
    }
    curve.push_back(knots.back());
    return Curve(std::move(curve));
}

cv::Vec3f wood_colour(const cv::Vec3f& wood, float along, float across, float strength, std::uint32_t seed) {
    // Rings seen from the side: long streaks, a few darker veins.
    const Vec stretched(along * 0.006F, across * 3.2F + 0.7F * smooth_noise({along * 0.008F, across}, seed));
    const float streaks = fractal_noise({stretched.x, stretched.y * 2}, 3, seed + 1);
    const float veins = smooth_step(0.55F, 0.95F, std::abs(std::sin(9 * (stretched.y + 0.4F * streaks))));
    return mix(wood * (1 + 0.10F * strength * streaks), wood * 0.80F, 0.35F * strength * veins);
}

void lay_part(Canvas& canvas, const Part& part, std::uint32_t seed) {
    const Curve curve = outline_of(part);
    const float whole = length(part.to - part.from);
    const float widest = *std::max_element(part.radii.begin(), part.radii.end());
    const Field shape = field(kSize, [&](Vec p) { return tube(p, curve); });
    const Paint colour = paint(kSize, [&](Vec p) {
        if (shape(cvFloor(p.y), cvFloor(p.x)) > 3) return part.wood;
        const CurvePlace place = nearest_on_curve(p, curve);
        // The band bows with the roundness of the wood.
        const float bow = 0.18F * widest * (1 - place.across * place.across) / whole;
        const float share = (p - part.from).dot(part.to - part.from) / (whole * whole) - bow;
        const cv::Vec3f wood = wood_colour(part.wood, place.along, place.across, part.grain, seed);
        const float painted = smooth_step(part.band_from - 0.008F, part.band_from + 0.008F, share) *
                              smooth_step(part.band_to + 0.008F, part.band_to - 0.008F, share);
        return mix(wood, part.band * (1 + 0.03F * fractal_noise(p * 0.05F, 2, seed)), painted * 0.96F);
    });
    const Field cover = coverage(shape);
    canvas.lay_inside(rgb(0x2b1708), blurred(moved(cover, {5, 8}), 8) * 0.55F);
    const bool squat = whole < 2 * widest;
    const Field round = squat ? dome(shape, widest * 1.02F, widest * 0.7F)
                              : field(kSize, [&](Vec p) { return 0.75F * tube_height(nearest_on_curve(p, curve)); });
    const Field height = blurred(round, 1 + 0.05F * widest);
    const Field rim =
        field(kSize, [&](Vec p) { return smooth_step(-4, 0, shape(cvFloor(p.y), cvFloor(p.x))) * 0.45F; });
    canvas.lay(lit(colour, height, {.contrast = 0.95F, .highlight = 0.30F, .gloss = 22}), cover);
    canvas.lay_inside(rgb(0x4a2a12), rim.mul(cover));
}

void lay_ball(Canvas& canvas, const Ball& ball) {
    const Field shape = field(kSize, [&](Vec p) { return circle(p, ball.at, ball.radius); });
    const Field cover = coverage(shape);
    canvas.lay_inside(rgb(0x2b1708), blurred(moved(cover, {3, 5}), 5) * 0.6F);
    const Paint colour = paint(kSize, [&](Vec p) { return wood_colour(rgb(0xa8703c), p.x, p.y * 0.02F, 1, 77); });
    canvas.lay(
        lit(colour, dome(shape, ball.radius, ball.radius * 0.8F), {.contrast = 1.0F, .highlight = 0.5F, .gloss = 34}),
        cover);
}

const cv::Vec3f kWood = rgb(0xe0b077), kRed = rgb(0xc0392f), kTeal = rgb(0x1f7f86), kYellow = rgb(0xe9b233);

std::vector<Part> limbs_of_one_side() {
    return {
        {{378, 392}, {262, 508}, {42, 45, 42, 36, 33}, kWood, kRed, -1, 0.34F},         // upper arm
        {{252, 520}, {152, 648}, {33, 39, 35, 28, 25}, kWood, kRed, 0.80F, 0.93F},      // forearm
        {{146, 662}, {106, 728}, {25, 34, 33, 23}, kWood, kRed, 2, 2},                  // hand
        {{436, 690}, {384, 868}, {56, 60, 55, 46, 42}, kWood, kTeal, -1, 0.46F},        // thigh
        {{380, 888}, {338, 1068}, {42, 48, 42, 31, 28}, kWood, kYellow, 0.74F, 0.86F},  // calf
        {{328, 1100}, {258, 1122}, {34, 38, 31}, kTeal, kTeal, 2, 2, 0.15F},            // foot
    };
}

std::vector<Ball> joints_of_one_side() {
    return {{{388, 384}, 31}, {{257, 514}, 23}, {{149, 656}, 16}, {{382, 878}, 29}, {{335, 1080}, 19}};
}

Part mirrored(Part part) {
    part.from = mirrored(part.from);
    part.to = mirrored(part.to);
    return part;
}

void lay_face(Canvas& canvas) {
    for (float side : {-1.0F, 1.0F}) {
        const Field eye = field(kSize, [&](Vec p) { return ellipse(p, {500 + side * 38, 158}, {9, 13}); });
        canvas.lay_inside(rgb(0x2a1a10), coverage(eye));
        const Field gleam = field(kSize, [&](Vec p) { return circle(p, {497 + side * 38, 153}, 3); });
        canvas.lay_inside(rgb(0xffffff), coverage(gleam) * 0.9F);
        const Field cheek =
            field(kSize, [&](Vec p) { return smooth_step(24, 2, length(p - Vec(500 + side * 54, 192))) * 0.55F; });
        canvas.lay_inside(rgb(0xd8583e), cheek);
    }
    const auto mouth =
        smooth_curve({{{470, 202}, 3}, {{484, 213}, 3.6F}, {{500, 217}, 3.8F}, {{516, 213}, 3.6F}, {{530, 202}, 3}});
    canvas.lay_inside(rgb(0x6b2417), coverage(field(kSize, [&](Vec p) { return tube(p, mouth); })));
}

void lay_body(Canvas& canvas) {
    lay_part(canvas, {{500, 262}, {500, 318}, {34, 30, 34}, kWood, kRed, 2, 2}, 1);               // neck
    lay_part(canvas, {{500, 622}, {500, 668}, {90, 106, 98, 76}, kTeal, kTeal, 2, 2, 0.15F}, 2);  // pelvis
    lay_ball(canvas, {{500, 560}, 62});
    lay_part(canvas, {{500, 376}, {500, 500}, {92, 112, 112, 98, 72}, kRed, kYellow, 0.62F, 0.74F, 0.15F}, 3);  // chest
    lay_part(canvas, {{500, 118}, {500, 206}, {86, 94, 88, 66}, kWood, kRed, 2, 2}, 4);                         // head
    lay_face(canvas);
}

void lay_cap(Canvas& canvas) {
    const Field cap = field(kSize, [](Vec p) {
        return std::max(ellipse(p, {500, 126}, {98, 106}), p.y - 104 - 14 * std::cos((p.x - 500) / 70));
    });
    const Paint felt = paint(kSize, [](Vec p) { return kRed * (1 + 0.05F * fractal_noise(p * 0.2F, 2, 9)); });
    const Field cover = coverage(cap);
    canvas.lay_inside(rgb(0x2b1708), blurred(moved(cover, {2, 6}), 6) * 0.6F);
    canvas.lay(lit(felt, blurred(dome(cap, 90, 62), 2), {.contrast = 0.9F, .highlight = 0.15F, .gloss = 12}), cover);
}

}  // namespace

puppetwarp::Image draw_figure() {
    Canvas canvas(kSize);
    const std::vector<Part> limbs = limbs_of_one_side();
    for (std::size_t i = 0; i < limbs.size(); ++i) {
        const auto seed = static_cast<std::uint32_t>(100 + 10 * i);
        lay_part(canvas, limbs[i], seed);
        lay_part(canvas, mirrored(limbs[i]), seed + 5);
    }
    lay_body(canvas);
    lay_cap(canvas);
    for (const Ball& joint : joints_of_one_side()) {
        lay_ball(canvas, joint);
        lay_ball(canvas, {mirrored(joint.at), joint.radius});
    }
    return canvas.image(CV_8U, true);
}

}  // namespace samples
