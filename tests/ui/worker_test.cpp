#include "model/worker.h"
#include "model/background_task.h"

#include <puppetwarp/base/errors.h>

#include <gtest/gtest.h>

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <vector>

namespace puppetwarp::ui {
namespace {

// A gate that the work waits at, so that tests decide when it goes on.
class Gate {
public:
    void arrive_and_wait(Progress& progress) {
        std::unique_lock lock(mutex_);
        ++arrived_;
        changed_.notify_all();
        while (!open_) {
            changed_.wait_for(lock, std::chrono::milliseconds(1));
            lock.unlock();
            progress.step("deform", 0);
            lock.lock();
        }
    }
    void wait_for_arrivals(int count) {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [&] { return arrived_ >= count; });
    }
    void open() {
        const std::lock_guard lock(mutex_);
        open_ = true;
        changed_.notify_all();
    }

private:
    std::mutex mutex_;
    std::condition_variable changed_;
    int arrived_ = 0;
    bool open_ = false;
};

// Notes what was finished, in order.
class Finished {
public:
    void add() {
        const std::lock_guard lock(mutex_);
        ++count_;
        changed_.notify_all();
    }
    void wait_for(int count) {
        std::unique_lock lock(mutex_);
        changed_.wait(lock, [&] { return count_ >= count; });
    }
    int count() {
        const std::lock_guard lock(mutex_);
        return count_;
    }

private:
    std::mutex mutex_;
    std::condition_variable changed_;
    int count_ = 0;
};

ShapeRequest request(std::uint64_t revision, bool live = false) {
    return {revision, nullptr, {}, live};
}

std::shared_ptr<const Shape> answer(const ShapeRequest& request) {
    auto shape = std::make_shared<Shape>();
    shape->revision = request.revision;
    return shape;
}

void wait_until_idle(const Worker& worker) {
    while (!worker.idle()) std::this_thread::yield();
}

TEST(WorkerTest, AnswersTheNewestRequestInTheEnd) {
    Finished finished;
    Worker worker([](const ShapeRequest& r, Progress&) { return answer(r); }, [&] { finished.add(); });
    EXPECT_EQ(worker.newest(), nullptr);
    for (std::uint64_t revision = 1; revision <= 500; ++revision) worker.submit(request(revision, revision % 2));
    wait_until_idle(worker);
    EXPECT_EQ(worker.newest()->revision, 500u);
}

TEST(WorkerTest, ANewerRequestCancelsTheOneAtWork) {
    Gate gate;
    Finished finished;
    Worker worker(
        [&](const ShapeRequest& r, Progress& progress) {
            if (r.revision == 1) gate.arrive_and_wait(progress);
            return answer(r);
        },
        [&] { finished.add(); });
    worker.submit(request(1));
    gate.wait_for_arrivals(1);
    worker.submit(request(2));  // the gate never opens: only cancelling can end the first
    finished.wait_for(1);
    EXPECT_EQ(worker.newest()->revision, 2u);
    EXPECT_EQ(finished.count(), 1);
}

TEST(WorkerTest, ALiveRequestIsFinishedAlthoughANewerLiveOneWaits) {
    Gate gate;
    Finished finished;
    std::vector<std::uint64_t> made;
    Worker worker(
        [&](const ShapeRequest& r, Progress& progress) {
            gate.arrive_and_wait(progress);
            made.push_back(r.revision);
            return answer(r);
        },
        [&] { finished.add(); });
    worker.submit(request(1, true));
    gate.wait_for_arrivals(1);
    worker.submit(request(2, true));
    worker.submit(request(3, true));
    gate.open();
    finished.wait_for(2);
    EXPECT_EQ(made, (std::vector<std::uint64_t>{1, 3}));
}

TEST(WorkerTest, TheEndOfADragCancelsTheLiveRequest) {
    Gate gate;
    Finished finished;
    Worker worker(
        [&](const ShapeRequest& r, Progress& progress) {
            if (r.live) gate.arrive_and_wait(progress);
            return answer(r);
        },
        [&] { finished.add(); });
    worker.submit(request(1, true));
    gate.wait_for_arrivals(1);
    worker.submit(request(2, false));
    finished.wait_for(1);
    EXPECT_EQ(worker.newest()->revision, 2u);
}

TEST(WorkerTest, MakesAShapeAgainWhileThereIsMoreOfIt) {
    Finished finished;
    int made = 0;
    Worker worker(
        [&](const ShapeRequest& r, Progress&) {
            auto shape = std::make_shared<Shape>(*answer(r));
            shape->more = ++made < 5;
            return shape;
        },
        [&] { finished.add(); });
    worker.submit(request(7, true));
    finished.wait_for(5);
    wait_until_idle(worker);
    EXPECT_EQ(made, 5);
    EXPECT_EQ(finished.count(), 5);
    EXPECT_EQ(worker.newest()->revision, 7u);
}

TEST(WorkerTest, ANewerRequestIsMadeInsteadOfMoreOfTheLast) {
    Finished finished;
    Worker worker(
        [&](const ShapeRequest& r, Progress&) {
            auto shape = std::make_shared<Shape>(*answer(r));
            shape->more = r.live;
            return shape;
        },
        [&] { finished.add(); });
    worker.submit(request(1, true));
    finished.wait_for(3);
    worker.submit(request(2));
    wait_until_idle(worker);
    EXPECT_EQ(worker.newest()->revision, 2u);
}

TEST(WorkerTest, EndsInTheMiddleOfWork) {
    Gate gate;
    {
        Worker worker(
            [&](const ShapeRequest& r, Progress& progress) {
                gate.arrive_and_wait(progress);
                return answer(r);
            },
            [] {});
        worker.submit(request(1));
        gate.wait_for_arrivals(1);
    }
    SUCCEED();
}

TEST(BackgroundTaskTest, TellsWhatCameOut) {
    Finished finished;
    BackgroundTask good(
        [](Progress& progress) {
            progress.step("write", 0.5);
            return std::string("done");
        },
        [&] { finished.add(); });
    finished.wait_for(1);
    EXPECT_TRUE(good.done());
    EXPECT_FALSE(good.failed());
    EXPECT_EQ(good.message(), "done");
    EXPECT_EQ(good.fraction(), 0.5);

    BackgroundTask bad([](Progress&) -> std::string { throw InvalidInput("x.png", "is full", "empty it"); },
                       [&] { finished.add(); });
    finished.wait_for(2);
    EXPECT_TRUE(bad.failed());
    EXPECT_EQ(bad.message(), "x.png: is full (empty it)");

    BackgroundTask odd([](Progress&) -> std::string { throw std::runtime_error("odd"); }, [&] { finished.add(); });
    finished.wait_for(3);
    EXPECT_TRUE(odd.failed());
    EXPECT_NE(odd.message().find("odd"), std::string::npos);
}

TEST(BackgroundTaskTest, IsCancelledWhenNobodyWantsItAnyMore) {
    Gate gate;
    {
        BackgroundTask task(
            [&](Progress& progress) {
                gate.arrive_and_wait(progress);
                return std::string();
            },
            [] {});
        gate.wait_for_arrivals(1);
    }
    SUCCEED();
}

}  // namespace
}  // namespace puppetwarp::ui
