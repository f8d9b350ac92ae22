#include "model/view_transform.h"

#include <gtest/gtest.h>

#include <random>

namespace puppetwarp::ui {
namespace {

constexpr double tolerance = 1e-9;
const ScreenRect viewport{{40, 60}, {1000, 700}};

TEST(ViewTransformTest, GoesThereAndBack) {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> uniform(-500, 500);
    ViewTransform view;
    for (int i = 0; i < 200; ++i) {
        view.zoom_about({uniform(random), uniform(random)}, i % 2 ? 1.3 : 0.8);
        view.pan({uniform(random), uniform(random)});
        const Point image(uniform(random), uniform(random));
        EXPECT_NEAR((view.image_from_screen(view.screen_from_image(image)) - image).norm(), 0, 1e-8);
    }
}

TEST(ViewTransformTest, ZoomKeepsWhatIsUnderThePointerAlsoAtTheLimits) {
    ViewTransform view;
    const Point pointer(333, 222);
    const Point held = view.image_from_screen(pointer);
    for (int i = 0; i < 50; ++i) view.zoom_about(pointer, 1.5);
    EXPECT_EQ(view.scale(), ViewTransform::max_scale);
    EXPECT_NEAR((view.image_from_screen(pointer) - held).norm(), 0, tolerance);
    for (int i = 0; i < 80; ++i) view.zoom_about(pointer, 0.5);
    EXPECT_EQ(view.scale(), ViewTransform::min_scale);
    EXPECT_NEAR((view.image_from_screen(pointer) - held).norm(), 0, 1e-6);
}

TEST(ViewTransformTest, FitShowsTheWholePictureInTheMiddle) {
    for (const Point& size : {Point(4000, 100), Point(100, 4000), Point(3000, 3000), Point(10, 10)}) {
        ViewTransform view;
        view.fit(size.x(), size.y(), viewport);
        EXPECT_TRUE(viewport.contains(view.screen_from_image({0, 0})));
        EXPECT_TRUE(viewport.contains(view.screen_from_image(size)));
        EXPECT_NEAR((view.screen_from_image(size / 2) - viewport.centre()).norm(), 0, tolerance);
    }
}

TEST(ViewTransformTest, ActualSizeShowsOnePixelAsOnePointAndKeepsTheMiddle) {
    ViewTransform view;
    view.fit(4000, 3000, viewport);
    view.set_scale(1, viewport);
    EXPECT_NEAR(view.scale(), 1, tolerance);
    EXPECT_NEAR((view.screen_from_image({2000, 1500}) - viewport.centre()).norm(), 0, 1e-6);
}

TEST(ViewTransformTest, AWindowThatGrowsKeepsTheMiddle) {
    ViewTransform view;
    view.fit(400, 300, viewport);
    const ScreenRect larger{{40, 60}, {1400, 900}};
    view.follow(viewport, larger);
    EXPECT_NEAR((view.screen_from_image({200, 150}) - larger.centre()).norm(), 0, tolerance);
}

}  // namespace
}  // namespace puppetwarp::ui
