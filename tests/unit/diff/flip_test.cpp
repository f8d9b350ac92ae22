// FLIP beside a plain double-precision loop after the paper's formulas, and its pieces beside known values.

#include "random_images.h"

#include <gtest/gtest.h>
#include <puppetwarp/base/threads.h>
#include <puppetwarp/diff/compare.h>
#include <puppetwarp/diff/flip.h>
#include <puppetwarp/diff/flip_colour.h>
#include <puppetwarp/diff/flip_filters.h>

#include <opencv2/core.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <vector>

namespace puppetwarp::testing {
namespace {

constexpr double kPi = std::numbers::pi;

using Field = std::vector<double>;  // one value a pixel

// A filter of (2 reach + 1)^2 weights over a field, the last pixel going on beyond the border.
Field filtered(const Field& field, int width, int height, int reach, const std::function<double(int, int)>& weight_of) {
    Field weights;
    for (int v = -reach; v <= reach; ++v) {
        for (int u = -reach; u <= reach; ++u) weights.push_back(weight_of(u, v));
    }
    Field result(field.size());
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            double sum = 0;
            std::size_t i = 0;
            for (int v = -reach; v <= reach; ++v) {
                for (int u = -reach; u <= reach; ++u) {
                    const int column = std::clamp(x + u, 0, width - 1), row = std::clamp(y + v, 0, height - 1);
                    sum += weights[i++] * field[static_cast<std::size_t>(row * width + column)];
                }
            }
            result[static_cast<std::size_t>(y * width + x)] = sum;
        }
    }
    return result;
}

// The weights of a filter, positive and negative ones scaled apart.
std::function<double(int, int)> scaled(int reach, const std::function<double(int, int)>& raw) {
    double positive = 0, negative = 0;
    for (int v = -reach; v <= reach; ++v) {
        for (int u = -reach; u <= reach; ++u) (raw(u, v) > 0 ? positive : negative) += std::abs(raw(u, v));
    }
    return [=](int u, int v) { return raw(u, v) / (raw(u, v) > 0 ? positive : negative); };
}

// Table 1 of the paper, the filter of section 4.1.1.
std::function<double(int, int)> sensitivity(double ppd, int reach, double a1, double b1, double a2, double b2) {
    return scaled(reach, [=](int u, int v) {
        const double r2 = (u * u + v * v) / (ppd * ppd);
        return a1 * std::sqrt(kPi / b1) * std::exp(-kPi * kPi * r2 / b1) +
               a2 * std::sqrt(kPi / b2) * std::exp(-kPi * kPi * r2 / b2);
    });
}

struct Triple {
    double a, b, c;
};

constexpr double kWhiteX = 0.950428545, kWhiteZ = 1.088900371;

Triple xyz_from_rgb(const Triple& rgb) {  // IEC 61966-2-1, divided by the white
    return {(0.412386563 * rgb.a + 0.357591491 * rgb.b + 0.180450491 * rgb.c) / kWhiteX,
            0.212636822 * rgb.a + 0.715182982 * rgb.b + 0.072180196 * rgb.c,
            (0.019330620 * rgb.a + 0.119197164 * rgb.b + 0.950372587 * rgb.c) / kWhiteZ};
}

// Cramer's rule, so that the code's inverse is checked too.
Triple rgb_from_xyz(const Triple& xyz) {
    const std::array<Triple, 3> columns{xyz_from_rgb({1, 0, 0}), xyz_from_rgb({0, 1, 0}), xyz_from_rgb({0, 0, 1})};
    const auto determinant = [](const Triple& p, const Triple& q, const Triple& r) {
        return p.a * (q.b * r.c - q.c * r.b) - q.a * (p.b * r.c - p.c * r.b) + r.a * (p.b * q.c - p.c * q.b);
    };
    const double all = determinant(columns[0], columns[1], columns[2]);
    return {determinant(xyz, columns[1], columns[2]) / all, determinant(columns[0], xyz, columns[2]) / all,
            determinant(columns[0], columns[1], xyz) / all};
}

Triple hunt_lab(const Triple& rgb) {
    const Triple xyz = xyz_from_rgb(rgb);
    const auto root = [](double t) {
        const double delta = 6.0 / 29;
        return t > delta * delta * delta ? std::cbrt(t) : t / (3 * delta * delta) + 4.0 / 29;
    };
    const double lightness = 116 * root(xyz.b) - 16;
    return {lightness, 0.01 * lightness * 500 * (root(xyz.a) - root(xyz.b)),
            0.01 * lightness * 200 * (root(xyz.b) - root(xyz.c))};
}

double slow_hyab(const Triple& p, const Triple& q) {
    return std::abs(p.a - q.a) + std::hypot(p.b - q.b, p.c - q.c);
}

struct Seen {
    std::vector<Triple> lab;
    Field edges, points;
};

Seen see(const Image& image, double ppd) {
    const int width = image.width(), height = image.height();
    std::array<Field, 3> opponent;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const auto linear = [&](int c) {
                const double v = sample(image, y, x, image.pixels.channels() < 3 ? 0 : c);
                return v > 0.04045 ? std::pow((v + 0.055) / 1.055, 2.4) : v / 12.92;
            };
            const Triple xyz = xyz_from_rgb({linear(0), linear(1), linear(2)});
            opponent[0].push_back(116 * xyz.b - 16);
            opponent[1].push_back(500 * (xyz.a - xyz.b));
            opponent[2].push_back(200 * (xyz.b - xyz.c));
        }
    }
    const int reach = static_cast<int>(std::ceil(3 * std::sqrt(0.04 / (2 * kPi * kPi)) * ppd));
    const Field a = filtered(opponent[0], width, height, reach, sensitivity(ppd, reach, 1, 0.0047, 0, 1e-5));
    const Field b = filtered(opponent[1], width, height, reach, sensitivity(ppd, reach, 1, 0.0053, 0, 1e-5));
    const Field c = filtered(opponent[2], width, height, reach, sensitivity(ppd, reach, 34.1, 0.04, 13.5, 0.025));
    Seen seen;
    for (std::size_t i = 0; i < a.size(); ++i) {
        const double y = (a[i] + 16) / 116;
        const Triple rgb = rgb_from_xyz({y + b[i] / 500, y, y - c[i] / 200});
        seen.lab.push_back(
            hunt_lab({std::clamp(rgb.a, 0.0, 1.0), std::clamp(rgb.b, 0.0, 1.0), std::clamp(rgb.c, 0.0, 1.0)}));
    }
    Field luminance;
    for (const double value : opponent[0]) luminance.push_back((value + 16) / 116);
    const double sigma = 0.5 * 0.082 * ppd;
    const int far = static_cast<int>(std::ceil(3 * sigma));
    const auto bell = [=](int u, int v) { return std::exp(-(u * u + v * v) / (2 * sigma * sigma)); };
    const auto edge = scaled(far, [=](int u, int v) { return -u * bell(u, v); });
    const auto point = scaled(far, [=](int u, int v) { return (u * u / (sigma * sigma) - 1) * bell(u, v); });
    const auto strength = [&](const std::function<double(int, int)>& weights) {
        const Field along_x = filtered(luminance, width, height, far, weights);
        const Field along_y = filtered(luminance, width, height, far, [&](int u, int v) { return weights(v, u); });
        Field result;
        for (std::size_t i = 0; i < along_x.size(); ++i) result.push_back(std::hypot(along_x[i], along_y[i]));
        return result;
    };
    seen.edges = strength(edge);
    seen.points = strength(point);
    return seen;
}

Field slow_flip(const Image& expected, const Image& actual, double ppd) {
    const Seen p = see(expected, ppd), q = see(actual, ppd);
    const double largest = std::pow(slow_hyab(hunt_lab({0, 1, 0}), hunt_lab({0, 0, 1})), 0.7);
    Field errors;
    for (std::size_t i = 0; i < p.lab.size(); ++i) {
        const double distance = std::pow(slow_hyab(p.lab[i], q.lab[i]), 0.7);
        const double knee = 0.4 * largest;
        const double colour =
            distance < knee ? 0.95 / knee * distance : 0.95 + (distance - knee) / (largest - knee) * 0.05;
        const double feature = std::sqrt(
            std::max(std::abs(p.edges[i] - q.edges[i]), std::abs(p.points[i] - q.points[i])) / std::numbers::sqrt2);
        errors.push_back(std::pow(colour, 1 - feature));
    }
    return errors;
}

// Soft spots of colour: what a picture is made of, rather than noise, which an eye averages away.
Image spots(int width, int height, int depth, int channels, std::mt19937& random) {
    Image image = blank_image(width, height, depth, channels);
    std::uniform_real_distribution<double> unit(0, 1);
    struct Spot {
        double x, y, radius;
        std::array<double, 3> colour;
    };
    std::vector<Spot> all;
    for (int i = 0; i < 12; ++i) {
        all.push_back({unit(random) * width,
                       unit(random) * height,
                       2 + 8 * unit(random),
                       {unit(random), unit(random), unit(random)}});
    }
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            for (int c = 0; c < channels; ++c) {
                double value = 0.5;
                for (const Spot& spot : all) {
                    const double share = std::exp(-std::pow(std::hypot(x - spot.x, y - spot.y) / spot.radius, 4));
                    value += share * (spot.colour[static_cast<std::size_t>(c % 3)] - value);
                }
                set_sample(image, y, x, c, value);
            }
        }
    }
    return image;
}

FlipFigures flip_of(const Image& expected, const Image& actual, double ppd, cv::Mat& errors) {
    cv::Mat marks = cv::Mat::zeros(expected.pixels.size(), CV_8U);
    errors = cv::Mat::zeros(expected.pixels.size(), CV_32F);
    const AlignedPair pair{
        expected.pixels, actual.pixels, {}, std::int64_t{expected.width()} * expected.height(), AlphaRule::straight};
    return flip(pair, ppd, 0.1, marks, &errors);
}

TEST(Flip, IsThatOfThePaper) {
    std::mt19937 random(9);
    for (const double ppd : {67.02, 30.0, 90.0}) {
        for (const int channels : {1, 3}) {
            const Image expected = spots(61, 47, CV_8U, channels, random);
            const Image actual =
                channels == 1 ? changed_image(expected, CV_8U, 30, random) : spots(61, 47, CV_16U, channels, random);
            cv::Mat errors;
            const FlipFigures figures = flip_of(expected, actual, ppd, errors);
            const Field slow = slow_flip(expected, actual, ppd);
            double sum = 0, largest = 0;
            for (int y = 0; y < 47; ++y) {
                for (int x = 0; x < 61; ++x) {
                    const double exact = slow[static_cast<std::size_t>(y * 61 + x)];
                    ASSERT_NEAR(errors.at<float>(y, x), exact, 2e-3) << ppd << ": " << x << "," << y;
                    sum += exact;
                    largest = std::max(largest, exact);
                }
            }
            EXPECT_NEAR(figures.mean, sum / (61 * 47), 2e-4);
            EXPECT_NEAR(figures.max, largest, 1e-3);
            EXPECT_GT(figures.mean, 0.01);
        }
    }
}

TEST(Flip, TilesWithTheSameBytesAreNotLookedAtAndChangeNothing) {
    std::mt19937 random(14);
    const Image expected = spots(280, 90, CV_8U, 3, random);
    Image actual;
    actual.pixels = expected.pixels.clone();
    actual.pixels.at<cv::Vec3b>(31, 255) = {255, 0, 255};
    actual.pixels.at<cv::Vec3b>(89, 5) = {0, 0, 0};
    cv::Mat errors;
    flip_of(expected, actual, 40, errors);
    const Field slow = slow_flip(expected, actual, 40);
    for (int y = 0; y < 90; ++y) {
        for (int x = 0; x < 280; ++x) {
            ASSERT_NEAR(errors.at<float>(y, x), slow[static_cast<std::size_t>(y * 280 + x)], 2e-3) << x << "," << y;
        }
    }
}

TEST(Flip, TheLargestDistanceIsThatOfGreenAndBlue) {
    EXPECT_NEAR(ColourError().largest(), 41.276, 2e-3);
    EXPECT_NEAR(ColourError().of(std::pow(41.276F, 1 / 0.7F)), 1, 1e-4);
    EXPECT_NEAR(ColourError().of(std::pow(0.4F * 41.276F, 1 / 0.7F)), 0.95, 1e-4);
    EXPECT_EQ(ColourError().of(0), 0);
}

TEST(Flip, LabIsThatOfTheStandard) {
    // L*a*b* (D65) of sRGB's red, white and a grey of 18 %, with the chromatic axes scaled by L / 100.
    const Colour red = hunt_lab_from_linear({1, 0, 0});
    EXPECT_NEAR(red.a, 53.24, 0.02);
    EXPECT_NEAR(red.b, 0.5324 * 80.09, 0.05);
    EXPECT_NEAR(red.c, 0.5324 * 67.20, 0.05);
    const Colour white = hunt_lab_from_linear({1, 1, 1});
    EXPECT_NEAR(white.a, 100, 1e-3);
    EXPECT_NEAR(white.b, 0, 1e-3);
    EXPECT_NEAR(white.c, 0, 1e-3);
    EXPECT_NEAR(hunt_lab_from_linear({0.18F, 0.18F, 0.18F}).a, 49.50, 0.01);
    EXPECT_NEAR(hunt_lab_from_linear({0, 0, 0}).a, 0, 1e-4);
}

TEST(Flip, OpponentColoursComeBack) {
    for (const Colour& rgb : {Colour{0.2F, 0.5F, 0.9F}, Colour{1, 0, 0}, Colour{0, 1, 1}, Colour{0.01F, 0.02F, 0}}) {
        const Colour back = linear_from_ycxcz(ycxcz_from_linear(rgb));
        EXPECT_NEAR(back.a, rgb.a, 1e-5);
        EXPECT_NEAR(back.b, rgb.b, 1e-5);
        EXPECT_NEAR(back.c, rgb.c, 1e-5);
    }
}

TEST(Flip, FiltersSumToWhatTheyShould) {
    for (const double ppd : {5.0, 30.0, 67.02, 200.0}) {
        const FlipFilters filters(ppd);
        const auto sum = [](const FilterSide& side) {
            double total = side.weight[0];
            for (std::size_t i = 1; i < side.weight.size(); ++i) total += 2 * side.weight[i];
            return total;
        };
        for (const FilterSide* side : {&filters.achromatic, &filters.red_green, &filters.blue_yellow[0],
                                       &filters.blue_yellow[1], &filters.gauss}) {
            EXPECT_NEAR(sum(*side), 1, 1e-5) << ppd;
        }
        EXPECT_NEAR(sum(filters.point), 0, 1e-5) << ppd;
        EXPECT_NEAR(sum(filters.edge), 2, 1e-5) << ppd;  // 1 on either side, of either sign
        EXPECT_NEAR(filters.blue_yellow_share[0] + filters.blue_yellow_share[1], 1, 1e-6);
    }
}

TEST(Flip, FastFunctionsAreThoseOfTheLibrary) {
    for (float value = 1e-20F; value < 1e20F; value *= 1.37F) {
        ASSERT_NEAR(fast_log2(value), std::log2(value), 4e-6 * (1 + std::abs(std::log2(value)))) << value;
        ASSERT_NEAR(fast_pow(value, 0.7F) / std::pow(value, 0.7F), 1, 1e-5) << value;
    }
    for (float power = -30; power < 30; power += 0.0137F) {
        ASSERT_NEAR(fast_exp2(power) / std::exp2(power), 1, 1e-6) << power;
    }
    EXPECT_EQ(fast_pow(0, 0.5F), 0);
}

TEST(Flip, ThePictureItselfHasNoErrorAndItsFigureMustBeOfTheWholeRange) {
    std::mt19937 random(10);
    const Image image = spots(300, 70, CV_8U, 3, random);
    const Comparison same = compare(image, image, {.metric = DiffMetric::flip});
    EXPECT_TRUE(same.same);
    EXPECT_EQ(same.flip, 0);
    EXPECT_EQ(same.flip_max_x, -1);
    Image black = blank_image(40, 40, CV_8U, 3), white = blank_image(40, 40, CV_8U, 3);
    white.pixels.setTo(cv::Scalar::all(255));
    const Comparison far = compare(black, white, {.metric = DiffMetric::flip});
    EXPECT_GT(far.flip.value(), 0.95);
    EXPECT_LE(far.flip_max, 1);
    EXPECT_EQ(far.flip_max_x, 0);
    EXPECT_EQ(far.flip_max_y, 0);
    EXPECT_EQ(far.differing_pixels, 1600);
}

TEST(Flip, FinePatternsAreSeenFromNearAndNotFromFar) {
    Image grey = blank_image(64, 64, CV_32F, 1), checks = blank_image(64, 64, CV_32F, 1);
    grey.pixels.setTo(0.735357F);  // as bright as black and white side by side
    for (int y = 0; y < 64; ++y) {
        for (int x = 0; x < 64; ++x) checks.pixels.at<float>(y, x) = static_cast<float>((x + y) % 2);
    }
    CompareOptions options{.metric = DiffMetric::flip,
                           .threshold = 0.1,
                           .ignore = {{0, 0, 64, 12}, {0, 52, 64, 12}, {0, 0, 12, 64}, {52, 0, 12, 64}}};
    options.pixels_per_degree = 200;
    EXPECT_TRUE(compare(grey, checks, options).same);
    options.pixels_per_degree = 20;
    EXPECT_FALSE(compare(grey, checks, options).same);
    EXPECT_FALSE(compare(grey, checks, {.threshold = 0.2}).same);
}

TEST(Flip, TilesAndThreadsLeaveNoTrace) {
    std::mt19937 random(11);
    const Image expected = spots(600, 130, CV_8U, 3, random), actual = spots(600, 130, CV_8U, 3, random);
    cv::Mat whole, part, alone;
    set_thread_count(4);
    const FlipFigures many = flip_of(expected, actual, 40, whole);
    set_thread_count(1);
    const FlipFigures one = flip_of(expected, actual, 40, alone);
    set_thread_count(0);
    EXPECT_EQ(many.mean, one.mean);
    EXPECT_EQ(many.max, one.max);
    EXPECT_EQ(many.max_x, one.max_x);
    EXPECT_EQ(cv::norm(whole, alone, cv::NORM_INF), 0);
    // A part of the picture has the same errors away from its border, wherever its tiles begin.
    const cv::Rect inner(101, 33, 400, 80);
    Image expected_part, actual_part;
    expected_part.pixels = expected.pixels(inner);
    actual_part.pixels = actual.pixels(inner);
    flip_of(expected_part, actual_part, 40, part);
    const cv::Rect within(10, 10, 380, 60);
    EXPECT_LT(cv::norm(part(within), whole(within + inner.tl()), cv::NORM_INF), 1e-6);
}

TEST(Flip, TransparencyIsSeenOverBlackOrWhite) {
    Image expected = blank_image(40, 40, CV_8U, 4), actual = blank_image(40, 40, CV_8U, 4);
    for (int y = 10; y < 30; ++y) {
        for (int x = 10; x < 30; ++x) actual.pixels.at<cv::Vec4b>(y, x) = {0, 0, 0, 255};
    }
    EXPECT_GT(compare(expected, actual, {.metric = DiffMetric::flip}).flip_max, 0.9);
    actual.pixels.setTo(cv::Scalar(9, 99, 9, 0));
    EXPECT_EQ(compare(expected, actual, {.metric = DiffMetric::flip}).flip_max, 0);
}

TEST(Flip, NanAndValuesBeyondTheRangeHaveAnError) {
    std::mt19937 random(12);
    Image expected = random_image(30, 30, CV_32F, 3, random);
    expected.pixels.at<cv::Vec3f>(3, 4)[1] = std::numeric_limits<float>::quiet_NaN();
    expected.pixels.at<cv::Vec3f>(13, 4)[1] = 1e30F;
    expected.pixels.at<cv::Vec3f>(23, 4)[1] = -std::numeric_limits<float>::infinity();
    Image actual;
    actual.pixels = expected.pixels.clone();
    EXPECT_EQ(compare(expected, actual, {.metric = DiffMetric::flip}).flip_max, 0);
    actual.pixels.at<cv::Vec3f>(3, 4)[1] = 0.5F;
    const Comparison comparison = compare(expected, actual, {.metric = DiffMetric::flip});
    EXPECT_GT(comparison.flip_max, 0);
    EXPECT_LE(comparison.flip_max, 1);
    EXPECT_FALSE(comparison.same);
}

}  // namespace
}  // namespace puppetwarp::testing
