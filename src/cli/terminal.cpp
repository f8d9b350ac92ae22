#include "terminal.h"

#include <puppetwarp/base/output_file.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <iterator>

#include <unistd.h>

namespace puppetwarp::cli {

namespace {

extern "C" void end_by_signal(int signal) {
    OutputFile::remove_temporaries();
    std::signal(signal, SIG_DFL);
    std::raise(signal);
}

}  // namespace

void install_signal_handlers() {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
        // Whoever started us may have asked to ignore a signal (nohup): keep that.
        if (std::signal(signal, end_by_signal) == SIG_IGN) std::signal(signal, SIG_IGN);
    }
    std::signal(SIGXFSZ, SIG_IGN);
}

void print_error(const std::string& message) {
    std::fprintf(stderr, "puppetwarp: %s\n", message.c_str());
}

void print_warning(const std::string& message) {
    print_error("warning: " + message);
}

ProgressBar::ProgressBar(bool quiet) : wanted_(!quiet && ::isatty(STDERR_FILENO) == 1) {}

ProgressBar::~ProgressBar() {
    if (drawn_) std::fputs("\r\033[K", stderr);
}

void ProgressBar::show(std::string_view stage, double fraction) {
    using namespace std::chrono_literals;
    const Clock::time_point now = Clock::now();
    if (!wanted_ || now - start_ < 1s || now - last_ < 50ms) return;
    constexpr int width = 30;
    const int filled = static_cast<int>(std::lround(std::clamp(fraction, 0.0, 1.0) * width));
    const std::string bar =
        std::string(static_cast<std::size_t>(filled), '#') + std::string(static_cast<std::size_t>(width - filled), '-');
    std::fprintf(stderr, "\r\033[K%-12.*s [%s] %3.0f %%", static_cast<int>(stage.size()), stage.data(), bar.c_str(),
                 100 * fraction);
    std::fflush(stderr);
    last_ = now;
    drawn_ = true;
}

}  // namespace puppetwarp::cli
