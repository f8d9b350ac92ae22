#pragma once

#include "model/shape.h"

#include <puppetwarp/base/progress.h>

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

namespace puppetwarp::ui {

//! A thread that makes shapes. Of the requests that wait only the newest counts.
//!
//! A newer request cancels the one at work, with one exception: a live one is not cancelled by another live one.
//! It is short, and when the pointer moves faster than shapes are made, each must still be shown.
//! A request whose shape says that there is `more` is made again until something else waits.
class Worker {
public:
    //! Makes one shape; called on the worker's thread only. \throw Cancelled
    using Make = std::function<std::shared_ptr<const Shape>(const ShapeRequest&, Progress&)>;

    //! \param finished  called on the worker's thread when `newest()` has changed.
    Worker(Make make, std::function<void()> finished);
    //! Cancels the work and waits for its end.
    ~Worker();
    Worker(const Worker&) = delete;
    Worker& operator=(const Worker&) = delete;

    void submit(ShapeRequest request);
    //! The newest shape that was finished; null before the first.
    std::shared_ptr<const Shape> newest() const;
    //! Nothing waits and nothing is at work.
    bool idle() const;

private:
    class Superseded;

    void run();
    bool superseded() const;

    const Make make_;
    const std::function<void()> finished_;
    mutable std::mutex mutex_;
    std::condition_variable wake_;
    std::optional<ShapeRequest> waiting_;
    bool working_ = false;
    bool working_live_ = false;
    bool stopping_ = false;
    std::shared_ptr<const Shape> newest_;
    std::thread thread_;  // last: starts when all else is there
};

}  // namespace puppetwarp::ui
