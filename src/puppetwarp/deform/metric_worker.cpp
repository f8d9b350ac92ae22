#include <puppetwarp/deform/metric_worker.h>

#include <puppetwarp/base/errors.h>

#include <utility>

namespace puppetwarp {

MetricWorker::MetricWorker() : thread_([this] { run(); }) {}

MetricWorker::~MetricWorker() {
    {
        const std::lock_guard lock(mutex_);
        ending_ = true;
    }
    changed_.notify_all();
    thread_.join();
}

bool MetricWorker::start(Work work) {
    {
        const std::lock_guard lock(mutex_);
        if (busy_ || result_) return false;
        work_ = std::move(work);
        busy_ = true;
    }
    changed_.notify_all();
    return true;
}

std::shared_ptr<ConstrainedMetric> MetricWorker::take() {
    const std::lock_guard lock(mutex_);
    return std::exchange(result_, nullptr);
}

void MetricWorker::drop() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return !busy_; });
    result_.reset();
}

void MetricWorker::run() {
    std::unique_lock lock(mutex_);
    while (true) {
        changed_.wait(lock, [this] { return ending_ || busy_; });
        if (!busy_) return;
        const Work work = std::exchange(work_, nullptr);
        lock.unlock();
        std::shared_ptr<ConstrainedMetric> result;
        try {
            result = work();
        } catch (const Error&) {
            // No factor of these positions: the descent goes on with the one it has, and asks again from others.
        } catch (const std::bad_alloc&) {
            // The same.
        }
        lock.lock();
        result_ = std::move(result);
        busy_ = false;
        changed_.notify_all();
    }
}

}  // namespace puppetwarp
