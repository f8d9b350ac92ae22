#include <puppetwarp/base/threads.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <mutex>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace puppetwarp {
namespace {

class Threads : public testing::Test {
protected:
    ~Threads() override { set_thread_count(0); }
};

TEST_F(Threads, CountIsWhatWasSet) {
    set_thread_count(0);
    const int all = thread_count();
    EXPECT_GE(all, 1);
    for (int count = 1; count <= all; ++count) {
        set_thread_count(count);
        EXPECT_EQ(thread_count(), count);
    }
}

TEST_F(Threads, MoreThanThereAreCoresAreAsManyAsCoresAndNobodyComplains) {
    testing::internal::CaptureStderr();
    set_thread_count(0);
    const int all = thread_count();
    set_thread_count(all + 7);
    parallel_for(0, 100, 1, [](int, int) {});
    EXPECT_EQ(thread_count(), all);
    EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
}

TEST_F(Threads, RangesDependOnTheGrainAlone) {
    for (const auto& [begin, end, grain] :
         {std::tuple{0, 100, 7}, {-5, 5, 3}, {3, 4, 10}, {0, 64, 64}, {0, 65, 64}, {0, 5, 0}}) {
        std::vector<std::pair<int, int>> expected;
        const int step = std::max(1, grain);
        for (int first = begin; first < end; first += step) expected.emplace_back(first, std::min(end, first + step));
        for (const int threads : {1, 2, 7}) {
            set_thread_count(threads);
            std::mutex mutex;
            std::vector<std::pair<int, int>> ranges;
            parallel_for(begin, end, grain, [&](int first, int last) {
                const std::lock_guard lock(mutex);
                ranges.emplace_back(first, last);
            });
            std::sort(ranges.begin(), ranges.end());
            EXPECT_EQ(ranges, expected) << threads << " threads";
        }
    }
}

TEST_F(Threads, EmptyAndReversedRangesDoNothing) {
    parallel_for(3, 3, 1, [](int, int) { FAIL(); });
    parallel_for(3, 2, 1, [](int, int) { FAIL(); });
}

TEST_F(Threads, LargeIndicesDoNotOverflow) {
    constexpr int end = 2'147'483'647;
    std::atomic<long long> sum{0};
    parallel_for(end - 10, end, 4, [&](int first, int last) { sum += last - first; });
    EXPECT_EQ(sum, 10);
}

TEST_F(Threads, TheExceptionOfTheLowestRangeComesOut) {
    for (const int threads : {1, 2, 5}) {
        set_thread_count(threads);
        std::atomic<int> calls{0};
        try {
            parallel_for(0, 50, 1, [&](int first, int) {
                ++calls;
                if (first >= 7) throw std::runtime_error(std::to_string(first));
            });
            FAIL() << "no exception";
        } catch (const std::runtime_error& error) {
            EXPECT_STREQ(error.what(), "7");
        }
        EXPECT_GE(calls, 8);
    }
}

}  // namespace
}  // namespace puppetwarp
