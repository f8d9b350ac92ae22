#include <puppetwarp/cutout/cutout.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/base/threads.h>

#include <gmock/gmock.h>
#include <opencv2/core.hpp>

#include <cmath>
#include <numbers>
#include <random>

namespace puppetwarp {

namespace {

Image picture(int type, const cv::Scalar& value, int width = 8, int height = 6) {
    return {cv::Mat(height, width, type, value), {}};
}

CutoutOptions from(CutoutSource source) {
    CutoutOptions options;
    options.from = source;
    return options;
}

CutoutOptions polygon(Polyline points, std::vector<Polyline> holes = {}) {
    CutoutOptions options = from(CutoutSource::polygon);
    options.points = std::move(points);
    options.holes = std::move(holes);
    return options;
}

bool equal(const cv::Mat& a, const cv::Mat& b) {
    return a.type() == b.type() && a.size() == b.size() && cv::norm(a, b, cv::NORM_INF) == 0;
}

bool inside_by_crossings(const Polyline& points, const Point& p) {
    bool inside = false;
    for (std::size_t k = 0; k < points.size(); ++k) {
        const Point &a = points[k], &b = points[(k + 1) % points.size()];
        if ((a.y() > p.y()) != (b.y() > p.y()) && p.x() < a.x() + (b.x() - a.x()) * (p.y() - a.y()) / (b.y() - a.y())) {
            inside = !inside;
        }
    }
    return inside;
}

}  // namespace

TEST(CutOut, AutomaticTakesAlphaWhenSomePixelIsMostlySeeThrough) {
    EXPECT_TRUE(cut_out(picture(CV_8UC3, {1, 2, 3})).whole);
    Image image = picture(CV_8UC4, {1, 2, 3, 255});
    EXPECT_TRUE(cut_out(image).whole);
    image.pixels.at<cv::Vec4b>(2, 3)[3] = 128;
    EXPECT_TRUE(cut_out(image).whole);
    image.pixels.at<cv::Vec4b>(2, 3)[3] = 127;
    const Cutout cutout = cut_out(image);
    ASSERT_FALSE(cutout.whole);
    EXPECT_EQ(cutout.matte.at<std::uint8_t>(2, 3), 127);
    EXPECT_EQ(cutout.matte.at<std::uint8_t>(0, 0), 255);
}

TEST(CutOut, AlphaMustBeThereAndVisible) {
    EXPECT_THROW(cut_out(picture(CV_8UC3, {}), from(CutoutSource::alpha)), InvalidInput);
    EXPECT_THROW(cut_out(picture(CV_8UC4, {9, 9, 9, 0}), from(CutoutSource::alpha)), InvalidInput);
    EXPECT_THROW(cut_out(picture(CV_16UC2, {9, 0})), InvalidInput);
    EXPECT_THROW(cut_out(picture(CV_32FC2, {9, std::nan("")}), from(CutoutSource::alpha)), InvalidInput);
}

TEST(CutOut, WholeNeedsNoAlpha) {
    EXPECT_TRUE(cut_out(picture(CV_8UC4, {9, 9, 9, 0}), from(CutoutSource::whole)).whole);
}

TEST(CutOut, MaskIsLumaTimesAlpha) {
    CutoutOptions options = from(CutoutSource::mask);
    options.mask = picture(CV_8UC1, {200});
    EXPECT_EQ(cut_out(picture(CV_8UC3, {}), options).matte.at<std::uint8_t>(1, 1), 200);
    options.mask = picture(CV_16UC2, {40000, 32768});
    EXPECT_NEAR(cut_out(picture(CV_8UC3, {}), options).matte.at<std::uint16_t>(1, 1), 40000 * 32768.0 / 65535, 1);
    options.mask = picture(CV_8UC3, {255, 0, 0});  // red, whose luma is 0.299
    EXPECT_NEAR(cut_out(picture(CV_8UC3, {}), options).matte.at<std::uint8_t>(1, 1), 0.299 * 255, 1);
    options.mask = picture(CV_32FC4, {1, 1, 1, 0.25});
    EXPECT_NEAR(cut_out(picture(CV_8UC3, {}), options).matte.at<float>(1, 1), 0.25, 1e-6);
}

TEST(CutOut, MaskMustFitAndShowSomething) {
    CutoutOptions options = from(CutoutSource::mask);
    EXPECT_THROW(cut_out(picture(CV_8UC3, {}), options), InvalidInput);
    options.mask = picture(CV_8UC1, {255}, 9, 6);
    EXPECT_THROW(cut_out(picture(CV_8UC3, {}), options), InvalidInput);
    options.mask = picture(CV_8UC1, {0});
    EXPECT_THROW(cut_out(picture(CV_8UC3, {}), options), InvalidInput);
}

TEST(CutOut, PolygonCoverageIsTheAreaOfEachPixel) {
    // Right border in the middle of pixel 4, lower border a quarter into pixel 3.
    const Cutout cutout = cut_out(picture(CV_8UC3, {}), polygon({{1, 1}, {4.5, 1}, {4.5, 3.25}, {1, 3.25}}));
    const auto at = [&](int i, int j) { return cutout.matte.at<std::uint8_t>(j, i); };
    EXPECT_EQ(at(0, 1), 0);
    EXPECT_EQ(at(1, 1), 255);
    EXPECT_EQ(at(4, 1), 128);
    EXPECT_EQ(at(2, 3), 64);
    EXPECT_EQ(at(4, 3), 32);
    EXPECT_EQ(at(5, 2), 0);
    EXPECT_EQ(at(2, 4), 0);
}

TEST(CutOut, PolygonCoverageAgreesWithManySamplesAndSumsToTheArea) {
    std::mt19937 random(13);
    std::uniform_real_distribution<double> radius(6, 30);
    for (int round = 0; round < 6; ++round) {
        // Some leave the picture on every side.
        const Point centre(20 + 3 * round, 16);
        Polyline points;
        double area = 0;
        for (int k = 0; k < 11; ++k) {
            const double t = 2 * std::numbers::pi * k / 11 * (round % 2 ? 1 : -1),
                         r = radius(random) * (round < 3 ? 0.5 : 1);
            points.emplace_back(centre.x() + r * std::cos(t), centre.y() + r * std::sin(t));
        }
        for (std::size_t k = 0; k < points.size(); ++k) {
            const Point &a = points[k], &b = points[(k + 1) % points.size()];
            area += 0.5 * (a.x() * b.y() - a.y() * b.x());
        }
        const cv::Mat matte = cut_out(picture(CV_8UC1, {}, 48, 32), polygon(points)).matte;
        for (int j = 0; j < 32; ++j) {
            for (int i = 0; i < 48; ++i) {
                int inside = 0;
                for (int k = 0; k < 400; ++k) {
                    inside += inside_by_crossings(points, {i + (k % 20 + 0.5) / 20, j + (k / 20 + 0.5) / 20});
                }
                ASSERT_NEAR(matte.at<std::uint8_t>(j, i), inside * 255 / 400.0, 9) << i << ", " << j;
            }
        }
        if (round < 3) {
            EXPECT_NEAR(cv::sum(matte)[0] / 255, std::abs(area), 0.3);
        }
    }
}

TEST(CutOut, PolygonHolesAreTakenAway) {
    const Cutout cutout = cut_out(
        picture(CV_8UC3, {}),
        polygon({{0, 0}, {8, 0}, {8, 6}, {0, 6}}, {{{2, 2}, {4, 2}, {4, 4}, {2, 4}}, {{3, 3}, {20, 3}, {20, 5}}}));
    EXPECT_EQ(cutout.matte.at<std::uint8_t>(0, 0), 255);
    EXPECT_EQ(cutout.matte.at<std::uint8_t>(2, 2), 0);
    EXPECT_EQ(cutout.matte.at<std::uint8_t>(3, 3), 0);
    EXPECT_EQ(cutout.matte.at<std::uint8_t>(1, 5), 255);
}

TEST(CutOut, PolygonFromFarAway) {
    const Cutout cutout = cut_out(picture(CV_8UC3, {}), polygon({{-1e8, -1e8}, {1e8, -1e8}, {1e8, 1e8}, {-1e8, 1e8}}));
    EXPECT_TRUE(equal(cutout.matte, cv::Mat(6, 8, CV_8U, cv::Scalar(255))));
}

TEST(CutOut, PolygonCoverageIsTheSameForAnyNumberOfThreads) {
    const CutoutOptions options = polygon({{-20, 10.3}, {350.7, -40}, {280.1, 390.2}, {100.5, 120.9}, {33.3, 500}});
    set_thread_count(1);
    const cv::Mat one = cut_out(picture(CV_8UC1, {}, 300, 400), options).matte;
    set_thread_count(3);
    const cv::Mat three = cut_out(picture(CV_8UC1, {}, 300, 400), options).matte;
    set_thread_count(0);
    EXPECT_TRUE(equal(one, three));
}

TEST(CutOut, RefusesUnusablePolygons) {
    const Image image = picture(CV_8UC3, {});
    EXPECT_THROW(cut_out(image, polygon({})), InvalidInput);
    EXPECT_THROW(cut_out(image, polygon({{0, 0}, {5, 5}})), InvalidInput);
    EXPECT_THROW(cut_out(image, polygon({{0, 0}, {5, 5}, {std::nan(""), 3}})), InvalidInput);
    EXPECT_THROW(cut_out(image, polygon({{0, 0}, {5, 5}, {INFINITY, 3}})), InvalidInput);
    EXPECT_THROW(cut_out(image, polygon({{0, 0}, {5, 5}, {5, 0}, {0, 5}})), InvalidInput);
    EXPECT_THROW(cut_out(image, polygon({{0, 0}, {3, 3}, {5, 5}})), InvalidInput);
    EXPECT_THROW(cut_out(image, polygon({{50, 50}, {60, 50}, {50, 60}})), InvalidInput);
    EXPECT_THROW(cut_out(image, polygon({{0, 0}, {8, 0}, {8, 6}}, {{{1, 1}, {2, 2}}})), InvalidInput);
}

TEST(ApplyCutout, SharesThePixelsOfWholeAndAlphaCutouts) {
    Image image = picture(CV_8UC4, {10, 20, 30, 100});
    EXPECT_EQ(apply_cutout(image, {true, {}}).pixels.data, image.pixels.data);
    const Cutout alpha = cut_out(image, from(CutoutSource::alpha));
    EXPECT_EQ(apply_cutout(image, alpha).pixels.data, image.pixels.data);
}

TEST(ApplyCutout, RoundsEveryProductToTheNearest) {
    for (int a = 0; a < 256; ++a) {
        cv::Mat matte(1, 256, CV_8U);
        for (int m = 0; m < 256; ++m) matte.at<std::uint8_t>(0, m) = static_cast<std::uint8_t>(m);
        Image image{cv::Mat(1, 256, CV_8UC2, cv::Scalar(7, a)), {}};
        const Image cut = apply_cutout(image, {false, matte});
        for (int m = 0; m < 256; ++m) {
            if (a == m && a == 255) continue;
            ASSERT_EQ(cut.pixels.at<cv::Vec2b>(0, m)[1], std::lround(a * m / 255.0)) << a << " times " << m;
            ASSERT_EQ(cut.pixels.at<cv::Vec2b>(0, m)[0], 7);
        }
    }
    std::mt19937 random(1);
    for (int k = 0; k < 1000; ++k) {
        const auto a = static_cast<std::uint16_t>(random()), m = static_cast<std::uint16_t>(random());
        Image image{cv::Mat(1, 1, CV_16UC4, cv::Scalar(1, 2, 3, a)), {}};
        const Image cut = apply_cutout(image, {false, cv::Mat(1, 1, CV_16U, cv::Scalar(m))});
        ASSERT_EQ(cut.pixels.at<cv::Vec4w>(0, 0)[3], a == m ? a : std::lround(a * (m / 65535.0)));
    }
}

TEST(ApplyCutout, GivesAlphaToPicturesWithoutAndConvertsDepths) {
    const Image grey = apply_cutout(picture(CV_8UC1, {50}), {false, cv::Mat(6, 8, CV_16U, cv::Scalar(32896))});
    ASSERT_EQ(grey.pixels.type(), CV_8UC2);
    EXPECT_EQ(grey.pixels.at<cv::Vec2b>(0, 0), cv::Vec2b(50, 128));
    const Image wide = apply_cutout(picture(CV_16UC3, {1, 2, 3}), {false, cv::Mat(6, 8, CV_8U, cv::Scalar(128))});
    ASSERT_EQ(wide.pixels.type(), CV_16UC4);
    EXPECT_EQ(wide.pixels.at<cv::Vec4w>(0, 0), cv::Vec4w(1, 2, 3, 128 * 257));
    const Image real =
        apply_cutout(picture(CV_32FC4, {1, 2, 3, 0.5}), {false, cv::Mat(6, 8, CV_32F, cv::Scalar(0.25))});
    EXPECT_EQ(real.pixels.at<cv::Vec4f>(0, 0), cv::Vec4f(1, 2, 3, 0.125));
}

TEST(ApplyCutout, LeavesTheGivenPictureAlone) {
    Image image = picture(CV_8UC4, {10, 20, 30, 200});
    image.metadata.icc = {1, 2, 3};
    const cv::Mat before = image.pixels.clone();
    const Image cut = apply_cutout(image, {false, cv::Mat(6, 8, CV_8U, cv::Scalar(100))});
    EXPECT_TRUE(equal(image.pixels, before));
    EXPECT_EQ(cut.metadata.icc, image.metadata.icc);
}

}  // namespace puppetwarp
