#include "model/input_events.h"

#include <gtest/gtest.h>

namespace puppetwarp::ui {
namespace {

using Kind = InputEvent::Kind;

InputEvent at(Kind kind, double x) {
    InputEvent event;
    event.kind = kind;
    event.screen = {x, 0};
    return event;
}

TEST(EventQueueTest, PressAndReleaseOfOneMomentComeInTwoFrames) {
    EventQueue queue;
    queue.push(at(Kind::press, 1));
    queue.push(at(Kind::release, 1));
    auto frame = queue.take_frame();
    ASSERT_EQ(frame.size(), 1u);
    EXPECT_EQ(frame[0].kind, Kind::press);
    frame = queue.take_frame();
    ASSERT_EQ(frame.size(), 1u);
    EXPECT_EQ(frame[0].kind, Kind::release);
    EXPECT_TRUE(queue.empty());
    EXPECT_TRUE(queue.take_frame().empty());
}

TEST(EventQueueTest, APressKeepsItsPlaceWhenMovesFollow) {
    EventQueue queue;
    for (double x : {1.0, 2.0}) queue.push(at(Kind::move, x));
    queue.push(at(Kind::press, 2));
    for (double x : {3.0, 4.0}) queue.push(at(Kind::move, x));
    const auto frame = queue.take_frame();
    ASSERT_EQ(frame.size(), 3u);
    EXPECT_EQ(frame.back().kind, Kind::press);
    EXPECT_EQ(frame.back().screen.x(), 2);
    EXPECT_EQ(queue.take_frame().back().screen.x(), 4);
}

}  // namespace
}  // namespace puppetwarp::ui
