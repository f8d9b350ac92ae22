#include "model/background_task.h"

#include <puppetwarp/base/errors.h>

#include <exception>
#include <utility>

namespace puppetwarp::ui {

class BackgroundTask::TaskProgress final : public Progress {
public:
    explicit TaskProgress(BackgroundTask& task) : task_(task) {}
    bool cancelled() const override { return task_.cancelled_; }

protected:
    void show(std::string_view, double fraction) override { task_.fraction_ = fraction; }

private:
    BackgroundTask& task_;
};

BackgroundTask::BackgroundTask(std::function<std::string(Progress&)> work, std::function<void()> finished)
    : thread_([this, work = std::move(work), finished = std::move(finished)] {
          TaskProgress progress(*this);
          try {
              message_ = work(progress);
          } catch (const Cancelled&) {
              message_ = "Cancelled";
          } catch (const Error& error) {
              failed_ = true;
              message_ = error.what();
          } catch (const std::exception& error) {
              failed_ = true;
              message_ = MachineFault("puppetwarp", error.what()).what();
          }
          done_ = true;
          finished();
      }) {}

BackgroundTask::~BackgroundTask() {
    cancelled_ = true;
    thread_.join();
}

}  // namespace puppetwarp::ui
