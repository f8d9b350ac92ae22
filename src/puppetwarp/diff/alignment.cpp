#include <puppetwarp/diff/alignment.h>

#include <puppetwarp/base/threads.h>
#include <puppetwarp/diff/row_difference.h>

#include <opencv2/core.hpp>

#include <algorithm>
#include <cstdlib>
#include <limits>
#include <numeric>
#include <vector>

namespace puppetwarp {

namespace {

// Rows are looked at in so many rounds, every kRounds-th row in each, so that a move that does not fit is given up
// after the first.
constexpr int kRounds = 16;
constexpr int kRowsATask = 8;

// Shortest first, then in reading order: the first best one is the answer.
std::vector<Shift> shifts_within(int reach_x, int reach_y) {
    std::vector<Shift> shifts;
    for (int y = -reach_y; y <= reach_y; ++y) {
        for (int x = -reach_x; x <= reach_x; ++x) shifts.push_back({x, y});
    }
    std::stable_sort(shifts.begin(), shifts.end(),
                     [](const Shift& a, const Shift& b) { return a.x * a.x + a.y * a.y < b.x * b.x + b.y * b.y; });
    return shifts;
}

// The pictures as one shift lays them on each other.
struct Overlay {
    cv::Mat expected, actual, selected;

    Overlay(const cv::Mat& all_expected, const cv::Mat& all_actual, const cv::Mat& all_selected, const Shift& shift) {
        const cv::Rect part = overlap(all_expected.size(), shift);
        expected = all_expected(part);
        actual = all_actual(part + cv::Point(shift.x, shift.y));
        if (!all_selected.empty()) selected = all_selected(part);
    }

    double pixels() const {
        return selected.empty() ? static_cast<double>(expected.total()) : cv::countNonZero(selected);
    }
};

template <class Difference>
double row_sum(RowDifference<Difference>& differences, const cv::Mat& selected, int y) {
    const Difference* row = differences.row(y, selected.empty() ? nullptr : selected.ptr(y));
    if (!row) return 0;
    // Rows of integers are too short to overflow 64 bits; and their sums are exact in double, too.
    using Sum = std::conditional_t<std::is_integral_v<Difference>, std::uint64_t, double>;
    return static_cast<double>(std::accumulate(row, row + differences.samples(), Sum{0}));
}

// The mean difference under one shift, or infinity when it is found to be over `give_up_over`.
template <class Difference>
double mean_difference(const Overlay& overlay, AlphaRule alpha, double give_up_over) {
    const double pixels = overlay.pixels();
    const int rows = overlay.expected.rows;
    double total = 0;
    for (int round = 0; round < std::min(kRounds, rows); ++round) {
        const int rows_now = (rows - round - 1) / kRounds + 1;
        std::vector<double> sums(static_cast<std::size_t>(rows_now));
        parallel_for(0, rows_now, kRowsATask, [&](int first, int last) {
            RowDifference<Difference> differences(overlay.expected, overlay.actual, alpha);
            for (int i = first; i < last; ++i) {
                sums[static_cast<std::size_t>(i)] = row_sum(differences, overlay.selected, round + i * kRounds);
            }
        });
        total = std::accumulate(sums.begin(), sums.end(), total);
        if (total > give_up_over * pixels) return std::numeric_limits<double>::infinity();
    }
    return total / pixels;
}

}  // namespace

cv::Rect overlap(const cv::Size& size, const Shift& shift) {
    return {std::max(0, -shift.x), std::max(0, -shift.y), size.width - std::abs(shift.x),
            size.height - std::abs(shift.y)};
}

Shift best_shift(const cv::Mat& expected, const cv::Mat& actual, const cv::Mat& selected, AlphaRule alpha,
                 int reach_px) {
    const auto mean = [&](const Overlay& overlay, double give_up_over) {
        return with_difference_of(expected, actual, alpha, [&](auto zero) {
            return mean_difference<decltype(zero)>(overlay, alpha, give_up_over);
        });
    };
    const double enough = Overlay(expected, actual, selected, {}).pixels() / 2;
    Shift best;
    double least = std::numeric_limits<double>::infinity();
    for (const Shift& shift :
         shifts_within(std::min(reach_px, expected.cols / 2), std::min(reach_px, expected.rows / 2))) {
        const Overlay overlay(expected, actual, selected, shift);
        if (overlay.pixels() < enough) continue;
        const double difference = mean(overlay, least);
        if (difference >= least) continue;
        least = difference;
        best = shift;
        if (least == 0) break;
    }
    return best;
}

}  // namespace puppetwarp
