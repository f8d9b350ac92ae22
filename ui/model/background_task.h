#pragma once

#include <puppetwarp/base/progress.h>

#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <thread>

namespace puppetwarp::ui {

//! One long piece of work on a thread of its own, such as an export.
class BackgroundTask {
public:
    //! \param work      does it and returns one line to show; may throw what the library throws.
    //! \param finished  called on the task's thread at the end.
    BackgroundTask(std::function<std::string(Progress&)> work, std::function<void()> finished);
    //! Cancels the work and waits for its end.
    ~BackgroundTask();
    BackgroundTask(const BackgroundTask&) = delete;
    BackgroundTask& operator=(const BackgroundTask&) = delete;

    bool done() const { return done_; }
    //! How far this stage is, in [0, 1].
    double fraction() const { return fraction_; }
    //! What the work returned, or why it failed, on one line. \pre done()
    const std::string& message() const { return message_; }
    bool failed() const { return failed_; }  //!< \pre done()

private:
    class TaskProgress;

    std::atomic<bool> cancelled_ = false;
    std::atomic<bool> done_ = false;
    std::atomic<double> fraction_ = 0;
    std::string message_;  // written before done_
    bool failed_ = false;  // likewise
    std::thread thread_;
};

}  // namespace puppetwarp::ui
