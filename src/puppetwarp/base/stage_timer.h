#pragma once

#include <chrono>
#include <string>
#include <utility>
#include <vector>

namespace puppetwarp {

//! Times stages of work one after the other, for reports.
class StageTimer {
public:
    //! \param timings_ms  grows by each stage; must outlive the timer.
    explicit StageTimer(std::vector<std::pair<std::string, double>>& timings_ms) : timings_ms_(timings_ms) {}

    //! The time since the last call, or since construction, belongs to `stage`.
    void end(const std::string& stage) {
        const auto now = std::chrono::steady_clock::now();
        timings_ms_.emplace_back(stage, std::chrono::duration<double, std::milli>(now - last_).count());
        last_ = now;
    }

private:
    std::vector<std::pair<std::string, double>>& timings_ms_;
    std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace puppetwarp
