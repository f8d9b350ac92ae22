#include "canvas.h"
#include "noise.h"
#include "samples.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace samples {

namespace {

const cv::Size kSize(1200, 940);
const float kMiddle = 360;  // the cat's axis, x

const cv::Vec3f kFur = rgb(0xdd8f46), kStripe = rgb(0xa75a22), kCream = rgb(0xf6e3c6), kShadow = rgb(0x2c1708);

// The cat is symmetric: both sides are drawn as its right one.
Vec folded(Vec p) {
    return {kMiddle + std::abs(p.x - kMiddle), p.y};
}

// Hairs at the edge and over the surface run downwards.
float hair(Vec p) {
    return fractal_noise({p.x * 0.16F, p.y * 0.05F}, 3, 71);
}

float hairy(float distance, Vec p) {
    return distance + 2.2F * hair(p);
}

cv::Vec3f combed(const cv::Vec3f& colour, Vec p) {
    return colour * (1 + 0.10F * hair(p) + 0.05F * fractal_noise(p * 0.01F, 2, 73));
}

void lay_furry(Canvas& canvas, const Field& shape, const std::function<cv::Vec3f(Vec)>& colour, float rim_px,
               float fade_y = -100) {
    // What grows out of the body at `fade_y` has no edge there.
    const Field fade = field(kSize, [&](Vec p) { return smooth_step(fade_y, fade_y + 60, p.y); });
    const Field cover = coverage(shape, 1.8F).mul(fade);
    canvas.lay_inside(kShadow, blurred(moved(cover, {3, 8}), 10) * 0.5F);
    Field height = blurred(dome(shape, rim_px, rim_px * 0.42F), 4);
    height += field(kSize, [](Vec p) { return 1.1F * hair(p); });
    const Paint fur =
        paint(kSize, [&](Vec p) { return cover(cvFloor(p.y), cvFloor(p.x)) > 0 ? combed(colour(p), p) : cv::Vec3f(); });
    canvas.lay(lit(fur, height, {.contrast = 0.85F, .highlight = 0.06F, .gloss = 8}), cover);
}

float stripes(float value, float sharpness = 0.35F) {
    return smooth_step(0.15F, 0.15F + sharpness, std::sin(value));
}

Curve tail_curve() {
    return smooth_curve({{{440, 800}, 14},
                         {{545, 842}, 13},
                         {{680, 850}, 12},
                         {{800, 800}, 11.5F},
                         {{866, 700}, 11},
                         {{866, 580}, 10.5F},
                         {{838, 470}, 10},
                         {{850, 360}, 9.5F},
                         {{920, 280}, 9},
                         {{1020, 270}, 8.5F},
                         {{1086, 336}, 8},
                         {{1072, 420}, 7.5F},
                         {{1012, 448}, 7},
                         {{972, 418}, 6.7F},
                         {{976, 372}, 6.4F},
                         {{1008, 356}, 6}},
                        14);
}

void lay_tail(Canvas& canvas) {
    const Curve curve = tail_curve();
    const Field shape = field(kSize, [&](Vec p) { return tube(p, curve) + 0.9F * hair(p * 1.4F); });
    const auto colour = [&](Vec p) {
        const CurvePlace place = nearest_on_curve(p, curve);
        const cv::Vec3f ringed = mix(kFur, kStripe, 0.8F * stripes(place.along * 0.11F));
        return mix(ringed, kStripe * 0.8F, smooth_step(1340, 1400, place.along));
    };
    lay_furry(canvas, shape, colour, 13);
}

float body_shape(Vec p) {
    const Vec q = folded(p);
    const float trunk = capsule(p, {kMiddle, 440}, {kMiddle, 690}, 98, 138);
    return hairy(join(trunk, ellipse(q, {kMiddle + 112, 735}, {98, 108}, 12), 40), p);
}

cv::Vec3f body_colour(Vec p) {
    const Vec q = folded(p);
    const float bib = smooth_step(20, -30, ellipse(p, {kMiddle, 500}, {62, 130}) + 9 * hair(p));
    const float side = smooth_step(55, 105, q.x - kMiddle);
    const float bands = stripes(q.y * 0.085F + 0.02F * (q.x - kMiddle) + 1.1F * smooth_noise(p * 0.012F, 75)) * side;
    return mix(mix(kFur, kStripe, 0.75F * bands), kCream, bib);
}

void lay_body(Canvas& canvas) {
    lay_furry(canvas, field(kSize, body_shape), body_colour, 130);
    for (float side : {-1.0F, 1.0F}) {
        const Field hind_paw = field(kSize, [&](Vec p) {
            return hairy(ellipse(p, {kMiddle + side * 142, 838}, {68, 32}), p);
        });
        lay_furry(
            canvas, hind_paw, [](Vec) { return kCream; }, 32);
    }
    for (float side : {-1.0F, 1.0F}) {
        const Field leg = field(kSize, [&](Vec p) {
            const float shank = capsule(p, {kMiddle + side * 46, 580}, {kMiddle + side * 50, 806}, 44, 38);
            return hairy(join(shank, ellipse(p, {kMiddle + side * 54, 838}, {52, 33}), 16), p);
        });
        const auto colour = [](Vec p) {
            const float bands = stripes(p.y * 0.10F + 1.5F) * smooth_step(600, 640, p.y);
            return mix(mix(kFur, kStripe, 0.6F * bands), kCream, smooth_step(775, 800, p.y + 6 * hair(p)));
        };
        lay_furry(canvas, leg, colour, 40, 555);
        for (float toe : {-15.0F, 15.0F}) {
            const auto line =
                smooth_curve({{{kMiddle + side * 54 + toe, 848}, 1.6F}, {{kMiddle + side * 54 + toe, 864}, 1.6F}});
            canvas.lay_inside(rgb(0x8a5a34), coverage(field(kSize, [&](Vec p) { return tube(p, line); }), 2) * 0.8F);
        }
    }
}

void lay_ears(Canvas& canvas) {
    const Field ears = field(kSize, [](Vec p) {
        return hairy(polygon(folded(p), {{kMiddle + 40, 190}, {kMiddle + 118, 108}, {kMiddle + 130, 240}}) - 17, p);
    });
    lay_furry(
        canvas, ears, [](Vec) { return kFur * 0.95F; }, 26);
    const Field inner = field(kSize, [](Vec p) {
        return polygon(folded(p), {{kMiddle + 70, 190}, {kMiddle + 112, 130}, {kMiddle + 119, 215}}) - 3 + 4 * hair(p);
    });
    canvas.lay_inside(rgb(0xe7a898), coverage(inner, 9) * 0.85F);
}

cv::Vec3f head_colour(Vec p) {
    const Vec q = folded(p);
    const float muzzle = smooth_step(
        12, -14,
        std::min(ellipse(q, {kMiddle + 30, 330}, {52, 42}), ellipse(p, {kMiddle, 372}, {60, 34})) + 6 * hair(p));
    const float forehead = stripes((q.x - kMiddle) * 0.14F + 1.4F) *
                           smooth_step(232, 190, p.y + 0.5F * (q.x - kMiddle)) * smooth_step(70, 55, q.x - kMiddle);
    const float cheeks =
        stripes(q.y * 0.13F + 0.04F * q.x) * smooth_step(96, 118, q.x - kMiddle) * smooth_step(230, 262, q.y);
    return mix(mix(kFur, kStripe, 0.85F * std::max(forehead, cheeks)), kCream, muzzle);
}

void lay_eye(Canvas& canvas, float side) {
    const Vec centre(kMiddle + side * 62, 268);
    const Field rim = field(kSize, [&](Vec p) { return ellipse(p, centre, {34, 31}, side * 14); });
    const Field iris = field(kSize, [&](Vec p) { return ellipse(p, centre, {29, 26}, side * 14); });
    const Field pupil = field(kSize, [&](Vec p) { return ellipse(p, centre, {11, 22}); });
    canvas.lay_inside(rgb(0x3a1d0b), coverage(rim, 2));
    const Paint green = paint(kSize, [&](Vec p) {
        const float rays = smooth_noise({std::atan2(p.y - centre.y, p.x - centre.x) * 9, side}, 77);
        return mix(rgb(0x5d8a34), rgb(0xcfdc6a), smooth_step(-22, 26, p.y - centre.y)) * (1 + 0.08F * rays);
    });
    canvas.lay_inside(green, coverage(iris, 2));
    canvas.lay_inside(rgb(0x14100c), coverage(pupil, 2.5F));
    canvas.lay_inside(rgb(0x14100c), blurred(coverage(iris), 3).mul(field(kSize, [&](Vec p) {
        return smooth_step(-8, -26, p.y - centre.y) * 0.6F;
    })));
    canvas.lay_inside(rgb(0xffffff), coverage(field(kSize, [&](Vec p) {
                          return ellipse(p, centre + Vec(-9, -9), {7, 8});
                      })));
    canvas.lay_inside(rgb(0xffffff),
                      coverage(field(kSize, [&](Vec p) { return circle(p, centre + Vec(10, 10), 3.5F); })) * 0.6F);
}

void lay_face(Canvas& canvas) {
    lay_eye(canvas, -1);
    lay_eye(canvas, 1);
    const Field nose = field(kSize, [](Vec p) {
        return polygon(p, {{kMiddle - 14, 310}, {kMiddle + 14, 310}, {kMiddle, 325}}) - 5;
    });
    canvas.lay_inside(
        lit(Paint(kSize, rgb(0xd9786c)), dome(nose, 9, 7), {.contrast = 0.8F, .highlight = 0.6F, .gloss = 20}),
        coverage(nose));
    for (float side : {-1.0F, 1.0F}) {
        const auto lip = smooth_curve({{{kMiddle, 330}, 2},
                                       {{kMiddle + side * 3, 346}, 2},
                                       {{kMiddle + side * 20, 356}, 2.2F},
                                       {{kMiddle + side * 38, 348}, 1.2F}});
        canvas.lay_inside(rgb(0x6d3a20), coverage(field(kSize, [&](Vec p) { return tube(p, lip); }), 1.6F) * 0.9F);
        for (int whisker = 0; whisker < 3; ++whisker) {
            const auto row = static_cast<float>(whisker);
            const auto line = smooth_curve({{{kMiddle + side * 44, 332 + 9 * row}, 1.3F},
                                            {{kMiddle + side * 92, 322 + 16 * row}, 1.1F},
                                            {{kMiddle + side * 142, 318 + 24 * row}, 0.5F}});
            canvas.lay_inside(rgb(0xfffaf0),
                              coverage(field(kSize, [&](Vec p) { return tube(p, line); }), 1.4F) * 0.95F);
        }
    }
}

void lay_head(Canvas& canvas) {
    const Field head = field(kSize, [](Vec p) {
        const float skull = ellipse(p, {kMiddle, 270}, {148, 122});
        return hairy(join(skull, ellipse(folded(p), {kMiddle + 92, 318}, {66, 52}), 40), p);
    });
    lay_furry(canvas, head, head_colour, 118);
}

// Laid first: soft alpha around the feet and along the part of the tail that lies on the ground.
void lay_ground_shadow(Canvas& canvas) {
    const Field spot = coverage(field(kSize, [](Vec p) { return ellipse(p, {kMiddle + 20, 858}, {225, 22}); }));
    const Curve lying = smooth_curve({{{480, 842}, 10}, {{570, 858}, 10}, {{690, 862}, 9}, {{775, 836}, 5}});
    const Field streak = coverage(field(kSize, [&](Vec p) { return tube(p, lying); }));
    const Field under_cat = blurred(spot, 15) * 0.55F, under_tail = blurred(streak, 6) * 0.5F;
    canvas.lay(rgb(0x1a1210), cv::max(under_cat, under_tail));
}

}  // namespace

puppetwarp::Image draw_tail() {
    Canvas canvas(kSize);
    lay_ground_shadow(canvas);
    lay_tail(canvas);
    lay_body(canvas);
    lay_ears(canvas);
    lay_head(canvas);
    lay_face(canvas);
    return canvas.image(CV_8U, true);
}

}  // namespace samples
