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
            editor.update();
        }
        editor.release();
    }

    std::mutex mutex;
    std::condition_variable woken;
    Editor editor{4096, [this] { woken.notify_all(); }};  // last: its threads end first
};

}  // namespace puppetwarp::ui
