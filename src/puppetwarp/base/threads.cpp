#include <puppetwarp/base/threads.h>

#include <opencv2/core/utility.hpp>

#include <algorithm>
#include <exception>
#include <vector>

namespace puppetwarp {

void set_thread_count(int count) {
    // OpenCV's task library prints a warning when it is asked for more threads than there are cores.
    cv::setNumThreads(count > 0 ? std::min(count, cv::getNumberOfCPUs()) : -1);
}

int thread_count() {
    return std::max(1, cv::getNumThreads());
}

void parallel_for(int begin, int end, int grain, const std::function<void(int first, int last)>& body) {
    if (begin >= end) return;
    grain = std::max(1, grain);
    const int ranges = (end - begin - 1) / grain + 1;
    std::vector<std::exception_ptr> errors(static_cast<std::size_t>(ranges));
    // One OpenCV stripe a range: OpenCV may hand several ranges to a thread, but never moves their borders.
    cv::parallel_for_(
        cv::Range(0, ranges),
        [&](const cv::Range& some) {
            for (int range = some.start; range < some.end; ++range) {
                const int first = begin + range * grain;
                try {
                    body(first, std::min(end - first, grain) + first);
                } catch (...) {
                    errors[static_cast<std::size_t>(range)] = std::current_exception();
                }
            }
        },
        ranges);
    for (const std::exception_ptr& error : errors) {
        if (error) std::rethrow_exception(error);
    }
}

}  // namespace puppetwarp
