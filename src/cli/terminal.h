#pragma once

#include <puppetwarp/base/progress.h>

#include <chrono>
#include <string>

namespace puppetwarp::cli {

//! Ctrl-C and its like remove temporary files and end the process by the signal; a file that grows over its limit
//! becomes an error like a full disk.
void install_signal_handlers();

//! One line `puppetwarp: MESSAGE` on standard error.
void print_error(const std::string& message);

//! One line `puppetwarp: warning: MESSAGE` on standard error.
void print_warning(const std::string& message);

//! A bar on standard error for work over a second, when that is a terminal.
class ProgressBar final : public Progress {
public:
    explicit ProgressBar(bool quiet);
    ~ProgressBar() override;
    ProgressBar(const ProgressBar&) = delete;
    ProgressBar& operator=(const ProgressBar&) = delete;

protected:
    void show(std::string_view stage, double fraction) override;

private:
    using Clock = std::chrono::steady_clock;
    bool wanted_;
    bool drawn_ = false;
    Clock::time_point start_ = Clock::now();
    Clock::time_point last_ = start_;
};

}  // namespace puppetwarp::cli
