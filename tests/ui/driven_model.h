#pragma once

#include "model/editor.h"

#include <gtest/gtest.h>

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>

namespace puppetwarp::ui {

//! The editor without its window, with a main loop that waits for its threads.
class DrivenModel : public testing::Test {
protected:
    //! The same drag ends in the same place on every machine, however busy.
    static constexpr Pace step_by_step{0, std::chrono::seconds(60), false};

    explicit DrivenModel(const Pace& pace = step_by_step)
        : timed(pace.metric_worker),
          editor(
              4096, [this] { woken.notify_all(); }, pace) {}

    static constexpr double image_px_per_point = 1;

    void run_until(const std::function<bool()>& done) {
        const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
        while (true) {
            editor.update();
            if (done()) return;
            ASSERT_LT(std::chrono::steady_clock::now(), deadline) << editor.message().text;
            std::unique_lock lock(mutex);
            woken.wait_for(lock, std::chrono::milliseconds(20));
        }
    }
    void settle() {
        run_until([this] { return editor.settled(); });
    }
    //! Waits until the picture has followed the pin that is dragged: to the end, or when timed, until it is seen.
    void follow() {
        run_until([this] { return editor.up_to_date() && (timed || !editor.shape()->more); });
    }
    void open(const std::filesystem::path& path) {
        editor.open(path);
        run_until([this] { return !editor.opening(); });
    }
    void click(const Point& at) {
        editor.press(at, image_px_per_point);
        editor.release();
        settle();
    }
    void drag(const Point& from, const Point& to) {
        editor.press(from, image_px_per_point);
        for (int i = 1; i <= 10; ++i) {
            editor.move(from + (to - from) * i / 10);
            follow();
        }
        editor.release();
    }

    const bool timed;
    std::mutex mutex;
    std::condition_variable woken;
    Editor editor;  // last: its threads end first
};

}  // namespace puppetwarp::ui
