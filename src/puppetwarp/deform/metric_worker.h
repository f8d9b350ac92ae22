#pragma once
// Private header.

#include <condition_variable>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>

namespace puppetwarp {

class ConstrainedMetric;

//! A thread that makes one metric at a time for whoever drags.
class MetricWorker {
public:
    using Work = std::function<std::shared_ptr<ConstrainedMetric>()>;

    MetricWorker();
    //! Waits for the work at hand.
    ~MetricWorker();
    MetricWorker(const MetricWorker&) = delete;
    MetricWorker& operator=(const MetricWorker&) = delete;

    //! \return false, and does nothing, while busy or while a result waits to be taken.
    bool start(Work work);
    //! The finished metric, or null. A failure of the work is a result that is never there: the old metric serves on.
    std::shared_ptr<ConstrainedMetric> take();
    //! Waits for the work at hand and drops its result.
    void drop();

private:
    void run();

    std::mutex mutex_;
    std::condition_variable changed_;
    Work work_;
    std::shared_ptr<ConstrainedMetric> result_;
    bool busy_ = false;
    bool ending_ = false;
    std::thread thread_;
};

}  // namespace puppetwarp
