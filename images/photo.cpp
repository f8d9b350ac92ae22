#include "canvas.h"
#include "noise.h"
#include "samples.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace samples {

namespace {

const cv::Size kSize(1120, 840);
constexpr float kHorizon = 500;  // where the table ends, y
constexpr float kFocus = 690;    // where it is sharp, y

// Lamps and leaves far out of focus behind the table.
cv::Vec3f wall(Vec p) {
    cv::Vec3f colour = mix(rgb(0x1c3136), rgb(0x54685a), smooth_step(0, 620, p.y + 0.25F * p.x));
    colour = mix(colour, rgb(0xc9a46a), 0.55F * smooth_step(520, 0, length(p - Vec(1010, 90))));
    colour = mix(colour, rgb(0x0d1c22), 0.6F * smooth_step(360, 0, length(p - Vec(40, 420))));
    return colour * (1 + 0.22F * smooth_noise(p * 0.006F, 90));
}

void lay_lights(Canvas& canvas) {
    for (int i = 0; i < 30; ++i) {
        const Vec centre(1120 * random_at(i, 0, 91), 430 * random_at(i, 1, 91));
        const float radius = 26 + 34 * random_at(i, 2, 91);
        const cv::Vec3f colour =
            mix(mix(rgb(0xf2c777), rgb(0xd8e0b0), random_at(i, 3, 91)), rgb(0x8fb7a6), 0.6F * random_at(i, 4, 91));
        // A lens draws a point out of focus as a disc, a little brighter at its rim.
        const Field disc = field(kSize, [&](Vec p) {
            const float distance = length(p - centre) - radius;
            return smooth_step(5, -5, distance) * (0.75F + 0.25F * smooth_step(-radius * 0.5F, 0, distance));
        });
        canvas.lay(colour, disc * (0.10F + 0.28F * random_at(i, 5, 91)));
    }
}

// Boards that run towards the horizon.
cv::Vec3f board(Vec p) {
    const float depth = 220 / (p.y - kHorizon + 70);
    const float u = (p.x - 560) * depth * 0.0045F, v = depth * 9;
    const float plank = std::floor(u * 1.25F);
    const float gap = std::abs(u * 1.25F - plank - 0.5F);
    const int index = static_cast<int>(plank);
    const Vec grained(u * 26 + 1.2F * smooth_noise({u * 3, v * 0.9F}, 92) + 40 * plank, v * 0.6F);
    const float streaks = fractal_noise(grained, 4, 93);
    const float veins =
        smooth_step(0.5F, 1.0F, std::abs(std::sin(6 * (u * 3 + 0.5F * smooth_noise({u * 2, v * 0.5F}, 94)))));
    cv::Vec3f colour = rgb(0x9a6a3e) * (0.88F + 0.22F * random_at(index, 0, 95) + 0.22F * streaks);
    colour = mix(colour, rgb(0x6a4022), 0.35F * veins);
    return mix(colour, rgb(0x2a170b), smooth_step(0.488F, 0.497F, gap));
}

void lay_table(Canvas& canvas) {
    const Paint sharp = paint(kSize, [](Vec p) { return p.y > kHorizon - 20 ? board(p) : rgb(0x6a4a2c); });
    std::vector<Field> channels(3);
    cv::split(sharp, channels.data());
    const auto softened = [&](float sigma) {
        const std::vector<cv::Mat> planes{blurred(channels[0], sigma), blurred(channels[1], sigma),
                                          blurred(channels[2], sigma)};
        Paint merged;
        cv::merge(planes, merged);
        return merged;
    };
    const Paint soft = softened(3), softer = softened(9);
    const Paint focused = paint(kSize, [&](Vec p) {
        const int x = cvFloor(p.x), y = cvFloor(p.y);
        const float blur = std::abs(p.y - kFocus) / 110;
        const cv::Vec3f near = mix(sharp(y, x), soft(y, x), std::clamp(blur, 0.0F, 1.0F));
        const cv::Vec3f colour = mix(near, softer(y, x), std::clamp(blur - 0.8F, 0.0F, 1.0F));
        const float light = 1.05F - 0.35F * smooth_step(0, 900, length(p - Vec(330, 640)));
        return colour * light + rgb(0x9fb0a8) * 0.22F * smooth_step(640, 500, p.y);
    });
    canvas.lay(focused, field(kSize, [](Vec p) { return smooth_step(kHorizon - 9, kHorizon + 9, p.y); }));
}

float pear_shape(Vec p) {
    const float belly = ellipse(p, {548, 570}, {168, 158}), top = ellipse(p, {566, 345}, {78, 92}, 8);
    return join(belly, top, 150) + 1.5F * smooth_noise(p * 0.01F, 96);
}

cv::Vec3f pear_skin(Vec p) {
    const float patches = fractal_noise(p * 0.008F, 3, 97);
    cv::Vec3f colour = mix(rgb(0xa9b23a), rgb(0xd9c24a), smooth_step(330, 640, p.y + 90 * patches));
    colour = mix(colour, rgb(0xbf4a26), 0.8F * smooth_step(530, 700, p.x + 60 * patches + 0.15F * (p.y - 500)));
    colour = mix(colour, rgb(0x8f7a2c), 0.5F * smooth_step(66, 10, length(p - Vec(570, 268)) + 20 * patches));
    const Vec cell(std::floor(p.x / 9), std::floor(p.y / 9));
    const int x = static_cast<int>(cell.x), y = static_cast<int>(cell.y);
    const Vec dot((cell.x + 0.2F + 0.6F * random_at(x, y, 98)) * 9, (cell.y + 0.2F + 0.6F * random_at(x, y, 99)) * 9);
    const float size = 2.1F * random_at(x, y, 100) - 0.5F;
    colour = mix(colour, rgb(0x6d5a22), 0.42F * smooth_step(size + 0.6F, size - 0.6F, length(p - dot)));
    return colour * (1 + 0.05F * fractal_noise(p * 0.05F, 2, 101));
}

void lay_stem(Canvas& canvas) {
    const Curve stem = smooth_curve({{{571, 276}, 8}, {{577, 240}, 6.5F}, {{592, 204}, 6.5F}, {{612, 180}, 9}});
    const Field shape = field(kSize, [&](Vec p) { return tube(p, stem); });
    const Paint bark =
        paint(kSize, [](Vec p) { return rgb(0x5c4022) * (1 + 0.3F * fractal_noise(p * 0.12F, 2, 102)); });
    canvas.lay(lit(bark, blurred(dome(shape, 8, 7), 1), {.contrast = 0.9F, .highlight = 0.15F, .gloss = 12}),
               coverage(shape, 1.6F));
}

void lay_leaf(Canvas& canvas) {
    const Curve rib =
        smooth_curve({{{588, 222}, 3}, {{640, 206}, 26}, {{700, 214}, 34}, {{756, 240}, 22}, {{792, 270}, 1.5F}}, 60);
    const Field shape = field(kSize, [&](Vec p) { return tube(p, rib); });
    const Paint green = paint(kSize, [&](Vec p) {
        const CurvePlace place = nearest_on_curve(p, rib);
        const float side = std::abs(place.across) * place.radius;
        const float veins = smooth_step(0.6F, 1, std::sin(0.30F * (place.along - 0.9F * side)));
        const cv::Vec3f blade = mix(rgb(0x3f6a26), rgb(0x6f9a3a), place.across < 0 ? 0.75F : 0.1F);
        return mix(blade, rgb(0xa3bd6a), std::max(0.35F * veins, smooth_step(2.4F, 1, side)));
    });
    canvas.lay(lit(green, blurred(dome(shape, 40, 9), 2), {.contrast = 0.8F, .highlight = 0.18F, .gloss = 14}),
               coverage(shape, 1.8F));
}

void lay_pear(Canvas& canvas) {
    const Field shape = field(kSize, pear_shape);
    const Field cover = coverage(shape, 1.8F);
    const Field shadow = coverage(field(kSize, [](Vec p) { return ellipse(p, {700, 730}, {280, 34}, 4); }));
    const Field contact = coverage(field(kSize, [](Vec p) { return ellipse(p, {556, 724}, {104, 15}); }));
    canvas.lay(rgb(0x120a06), blurred(shadow, 20) * 0.62F);
    canvas.lay(rgb(0x0a0503), blurred(contact, 8) * 0.8F);
    const Field height = blurred(dome(shape, 150, 128), 9);
    const Paint skin =
        paint(kSize, [&](Vec p) { return cover(cvFloor(p.y), cvFloor(p.x)) > 0 ? pear_skin(p) : cv::Vec3f(); });
    canvas.lay(lit(skin, height, {.contrast = 1.0F, .highlight = 0.16F, .gloss = 10}), cover);
    // The table lights it from below, and a window is mirrored in it.
    const Field below = field(kSize, [&](Vec p) {
        return 0.32F * smooth_step(-46, -6, shape(cvFloor(p.y), cvFloor(p.x))) * smooth_step(610, 715, p.y);
    });
    canvas.lay(rgb(0xb07a45), below.mul(cover));
    const Field window = field(kSize, [](Vec p) {
        return std::max(rounded_box(p, {482, 512}, {30, 44}, 14), 3.0F - std::abs(p.x - 484 + 0.1F * (p.y - 512)));
    });
    canvas.lay(rgb(0xfffbe8), blurred(coverage(window), 5.5F) * 0.62F);
    const Field upper = field(kSize, [](Vec p) { return ellipse(p, {533, 330}, {15, 34}, 8); });
    canvas.lay(rgb(0xfffbe8), blurred(coverage(upper), 8) * 0.42F);
}

// What a lens and a sensor add: softness, darker corners, grain.
puppetwarp::Image exposed(const Canvas& canvas) {
    puppetwarp::Image picture = canvas.image(CV_8U, false);
    for (int y = 0; y < picture.height(); ++y) {
        for (int x = 0; x < picture.width(); ++x) {
            auto& pixel = picture.pixels.at<cv::Vec3b>(y, x);
            const Vec off(static_cast<float>(x) / 560 - 1, static_cast<float>(y) / 420 - 1);
            const float vignette = 1 - 0.16F * off.dot(off);
            const float luma = grain(x, y, 103);
            for (int channel = 0; channel < 3; ++channel) {
                const float value = static_cast<float>(pixel[channel]) * vignette;
                const float noise = 0.9F * luma + 0.6F * grain(x, y, 110 + 10 * static_cast<std::uint32_t>(channel));
                pixel[channel] = cv::saturate_cast<std::uint8_t>(cvRound(value + noise));
            }
        }
    }
    return picture;
}

}  // namespace

puppetwarp::Image draw_photo() {
    Canvas canvas(kSize);
    canvas.lay(paint(kSize, wall), Field(kSize, 1.0F));
    lay_lights(canvas);
    lay_table(canvas);
    lay_pear(canvas);
    lay_stem(canvas);
    lay_leaf(canvas);
    return exposed(canvas);
}

}  // namespace samples
