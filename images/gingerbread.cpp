#include "canvas.h"
#include "noise.h"
#include "samples.h"

#include <cmath>
#include <vector>

namespace samples {

namespace {

const cv::Size kSize(800, 1000);

float body_shape(Vec p) {
    // A little waviness: dough is never cut quite straight.
    p += Vec(smooth_noise(p * 0.012F, 3), smooth_noise(p * 0.012F, 4)) * 3.0F;
    const float trunk = capsule(p, {400, 430}, {400, 590}, 122, 138);
    const float head = ellipse(p, {400, 205}, {152, 142});
    const float arms = std::min(capsule(p, {340, 420}, {122, 400}, 68, 72), capsule(p, {460, 420}, {678, 400}, 68, 72));
    const float legs = std::min(capsule(p, {336, 640}, {258, 862}, 84, 86), capsule(p, {464, 640}, {542, 862}, 84, 86));
    return join(join(join(trunk, head, 46), arms, 60), legs, 40);
}

cv::Vec3f baked(Vec p, float inside) {
    const float rim = smooth_step(70, 0, inside);
    const float patches = fractal_noise(p * 0.011F, 3, 11);
    cv::Vec3f colour = mix(rgb(0xb9763a), rgb(0x8a4e22), 0.75F * rim);
    colour *= 1 + 0.09F * patches + 0.045F * fractal_noise(p * 0.09F, 2, 17);
    return colour;
}

// Pores and crumbs of the surface.
float crumb(Vec p) {
    const float pores = smooth_step(0.42F, 0.75F, fractal_noise(p * 0.16F, 2, 23));
    return 1.3F * smooth_noise(p * 0.05F, 29) + 0.7F * smooth_noise(p * 0.14F, 31) - 3.2F * pores;
}

using Strokes = std::vector<Curve>;

Curve zigzag(Vec from, Vec to, Vec swing, int turns, float radius) {
    std::vector<CurvePoint> knots;
    for (int i = 0; i <= turns; ++i) {
        const float share = static_cast<float>(i) / static_cast<float>(turns);
        knots.push_back({from + (to - from) * share + swing * (i % 2 == 0 ? 1.0F : -1.0F), radius});
    }
    return smooth_curve(knots, 10);
}

Strokes icing_strokes() {
    Strokes strokes;
    strokes.push_back(zigzag({153, 362}, {150, 440}, {14, 0}, 4, 7.5F));
    strokes.push_back(zigzag({647, 362}, {650, 440}, {-14, 0}, 4, 7.5F));
    strokes.push_back(zigzag({214, 812}, {320, 850}, {5, -15}, 6, 7.5F));
    strokes.push_back(zigzag({586, 812}, {480, 850}, {-5, -15}, 6, 7.5F));
    strokes.push_back(
        smooth_curve({{{330, 238}, 7.5F}, {{358, 268}, 8}, {{400, 280}, 8.5F}, {{442, 268}, 8}, {{470, 238}, 7.5F}}));
    strokes.push_back(smooth_curve({{{326, 143}, 6}, {{346, 131}, 7}, {{368, 137}, 6}}));
    strokes.push_back(smooth_curve({{{432, 137}, 6}, {{454, 131}, 7}, {{474, 143}, 6}}));
    return strokes;
}

float icing_shape(Vec p, const Strokes& strokes, float body) {
    float nearest = std::abs(body + 25 + 2 * smooth_noise(p * 0.02F, 41)) - 6.2F;
    for (const auto& stroke : strokes) nearest = join(nearest, tube(p, stroke), 6);
    nearest = std::min(nearest, circle(p, {347, 186}, 21));
    return std::min(nearest, circle(p, {453, 186}, 21));
}

void lay_icing(Canvas& canvas, const Field& body) {
    const Strokes strokes = icing_strokes();
    const Field icing = field(kSize, [&](Vec p) { return icing_shape(p, strokes, body(cvFloor(p.y), cvFloor(p.x))); });
    const Field cover = coverage(icing);
    canvas.lay_inside(rgb(0x3d1c08), blurred(moved(cover, {3, 5}), 4) * 0.65F);
    Field height = dome(icing, 8, 7);
    canvas.lay_inside(
        lit(Paint(kSize, rgb(0xf6efe3)), blurred(height, 0.8F), {.contrast = 0.55F, .highlight = 0.35F, .gloss = 30}),
        cover);
}

// A sweet: round, glossy, with a soft light inside on the far side of the lamp.
void lay_sweet(Canvas& canvas, Vec centre, float radius, const cv::Vec3f& colour) {
    const Field shape = field(kSize, [&](Vec p) { return circle(p, centre, radius); });
    const Field cover = coverage(shape);
    canvas.lay_inside(rgb(0x2a1004), blurred(moved(cover, {4, 6}), 5) * 0.7F);
    const Paint inner = paint(kSize, [&](Vec p) {
        const float glow = smooth_step(radius * 1.1F, 0, length(p - centre - Vec(0.35F, 0.5F) * radius));
        return mix(colour, colour * 1.3F + cv::Vec3f(0.16F, 0.12F, 0.1F), 0.65F * glow);
    });
    canvas.lay_inside(
        lit(inner, dome(shape, radius, radius * 0.8F), {.contrast = 0.6F, .highlight = 0.95F, .gloss = 60}), cover);
}

float bow_shape(Vec p) {
    const Vec q(std::abs(p.x - 400) + 400, p.y);  // both halves are one
    const std::vector<Vec> loop{{408, 326}, {470, 292}, {484, 326}, {470, 360}};
    return polygon(q, loop) - 11;
}

void lay_bow(Canvas& canvas) {
    const Field bow = field(kSize, bow_shape), knot = field(kSize, [](Vec p) {
                                                   return rounded_box(p, {400, 326}, {19, 22}, 14);
                                               });
    const Field pleats = field(kSize, [](Vec p) {
        const float from_knot = std::abs(p.x - 400);
        return 2.5F * std::sin((p.y - 326) / (8 + 0.16F * from_knot) * 3) * smooth_step(90, 20, from_knot);
    });
    const Surface fondant{.contrast = 0.75F, .highlight = 0.35F, .gloss = 26};
    canvas.lay_inside(rgb(0x2a1004), blurred(moved(coverage(bow), {4, 7}), 6) * 0.7F);
    canvas.lay_inside(lit(Paint(kSize, rgb(0xb81f2b)), blurred(dome(bow, 26, 13) + pleats, 1.2F), fondant),
                      coverage(bow));
    canvas.lay_inside(rgb(0x2a1004), blurred(moved(coverage(knot), {2, 3}), 5).mul(coverage(bow)) * 0.6F);
    canvas.lay_inside(lit(Paint(kSize, rgb(0xc9252f)), blurred(dome(knot, 20, 15), 1), fondant), coverage(knot));
}

}  // namespace

puppetwarp::Image draw_gingerbread() {
    Canvas canvas(kSize);
    const Field body = field(kSize, body_shape);
    Field height = blurred(dome(body, 46, 21), 3);
    height += field(kSize, crumb);
    const Paint dough = paint(kSize, [&](Vec p) { return baked(p, -body(cvFloor(p.y), cvFloor(p.x))); });
    canvas.lay(lit(dough, height, {.contrast = 1.0F, .highlight = 0.10F, .gloss = 9}), coverage(body));

    const Field cheeks = field(kSize, [](Vec p) {
        return smooth_step(34, 6, length(p - Vec(300, 222))) + smooth_step(34, 6, length(p - Vec(500, 222)));
    });
    canvas.lay_inside(rgb(0xd9614a), cheeks * 0.55F);
    lay_icing(canvas, body);
    lay_bow(canvas);
    lay_sweet(canvas, {347, 186}, 13, rgb(0x33190c));
    lay_sweet(canvas, {453, 186}, 13, rgb(0x33190c));
    lay_sweet(canvas, {400, 425}, 24, rgb(0xc8202c));
    lay_sweet(canvas, {400, 510}, 24, rgb(0x2c8a3c));
    lay_sweet(canvas, {400, 595}, 24, rgb(0xc8202c));
    return canvas.image(CV_8U, true);
}

}  // namespace samples
