#include "model/worker.h"

#include <utility>

namespace puppetwarp::ui {

class Worker::Superseded final : public Progress {
public:
    explicit Superseded(const Worker& worker) : worker_(worker) {}
    bool cancelled() const override { return worker_.superseded(); }

private:
    const Worker& worker_;
};

Worker::Worker(Make make, std::function<void()> finished)
    : make_(std::move(make)), finished_(std::move(finished)), thread_([this] { run(); }) {}

Worker::~Worker() {
    {
        const std::lock_guard lock(mutex_);
        stopping_ = true;
    }
    wake_.notify_all();
    thread_.join();
}

void Worker::submit(ShapeRequest request) {
    {
        const std::lock_guard lock(mutex_);
        waiting_ = std::move(request);
    }
    wake_.notify_all();
}

std::shared_ptr<const Shape> Worker::newest() const {
    const std::lock_guard lock(mutex_);
    return newest_;
}

bool Worker::idle() const {
    const std::lock_guard lock(mutex_);
    return !waiting_ && !working_;
}

bool Worker::superseded() const {
    const std::lock_guard lock(mutex_);
    return stopping_ || (waiting_ && !(working_live_ && waiting_->live));
}

void Worker::run() {
    Superseded progress(*this);
    std::unique_lock lock(mutex_);
    while (true) {
        wake_.wait(lock, [this] { return stopping_ || waiting_; });
        if (stopping_) return;
        const ShapeRequest request = *std::exchange(waiting_, std::nullopt);
        working_ = true;
        working_live_ = request.live;
        lock.unlock();
        std::shared_ptr<const Shape> shape;
        try {
            shape = make_(request, progress);
        } catch (const Cancelled&) {
        }
        lock.lock();
        working_ = false;
        if (!shape) continue;
        if (shape->more && !waiting_) waiting_ = request;
        newest_ = std::move(shape);
        lock.unlock();
        finished_();
        lock.lock();
    }
}

}  // namespace puppetwarp::ui
