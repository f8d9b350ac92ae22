#include <puppetwarp/cutout/coverage.h>

#include <puppetwarp/base/threads.h>

#include <algorithm>
#include <cmath>

namespace puppetwarp {

namespace {

constexpr int rows_a_task = 64;

// Signed area that edges cut off to their right, a pixel row at a time: `within` takes what lies in the pixel itself,
// `beyond` what the edge's height adds to every pixel further right.
struct RowSums {
    std::vector<double> within, beyond;

    explicit RowSums(int width) : within(static_cast<std::size_t>(width) + 1), beyond(within.size()) {}
    void clear() {
        std::fill(within.begin(), within.end(), 0.0);
        std::fill(beyond.begin(), beyond.end(), 0.0);
    }

    // A piece of edge inside one pixel column, of signed height `height`, its mean x at `x`.
    void add(int column, double x, double height) {
        const auto i = static_cast<std::size_t>(column);
        within[i] += height * (column + 1 - x);
        beyond[i] += height;
    }
};

// The part of edge a-b inside the row whose top is `row`, cut at pixel columns; left of the picture everything
// counts as at x = 0, right of it nothing matters.
void add_edge(RowSums& sums, const Point& a, const Point& b, int row, int width) {
    const double sign = b.y() > a.y() ? 1 : -1;
    const Point& top = sign > 0 ? a : b;
    const Point& bottom = sign > 0 ? b : a;
    const double y0 = std::max(top.y(), static_cast<double>(row)), y1 = std::min(bottom.y(), row + 1.0);
    if (!(y1 > y0)) return;
    const double slope = (bottom.x() - top.x()) / (bottom.y() - top.y());
    const double xa = top.x() + (y0 - top.y()) * slope, xb = top.x() + (y1 - top.y()) * slope;
    const double left = std::min(xa, xb), right = std::max(xa, xb);
    const double height = sign * (y1 - y0);
    const double run = right - left;
    const auto height_until = [&](double x) { return run > 0 ? std::clamp((x - left) / run, 0.0, 1.0) * height : 0.0; };
    if (left < 0) {
        const double outside = right > 0 ? height_until(0) : height;
        sums.add(0, 0, outside);
        if (right <= 0) return;
    }
    const int first = std::max(0, static_cast<int>(std::floor(std::min(left, static_cast<double>(width)))));
    for (int column = first; column < width && column <= right; ++column) {
        const double x0 = std::max(left, static_cast<double>(column)), x1 = std::min(right, column + 1.0);
        const double part = run > 0 ? height_until(x1) - height_until(x0) : height;
        sums.add(column, 0.5 * (x0 + x1), part);
        if (!(run > 0)) break;
    }
}

// Folds a winding sum to even-odd coverage: 0 and 2 are outside, 1 and -1 inside.
double even_odd(double winding) {
    const double folded = std::abs(winding - 2 * std::floor(winding / 2 + 0.5));
    return std::min(folded, 1.0);
}

}  // namespace

cv::Mat polygon_coverage(const std::vector<Polyline>& polygons, int width, int height) {
    struct Edge {
        Point a, b;
    };
    std::vector<std::vector<Edge>> of_task(static_cast<std::size_t>((height + rows_a_task - 1) / rows_a_task));
    for (const Polyline& polygon : polygons) {
        for (std::size_t k = 0; k < polygon.size(); ++k) {
            const Edge edge{polygon[k], polygon[(k + 1) % polygon.size()]};
            const double top = std::max(0.0, std::min(edge.a.y(), edge.b.y()));
            const double bottom = std::min(static_cast<double>(height), std::max(edge.a.y(), edge.b.y()));
            if (!(top < bottom)) continue;
            const auto last = std::min(of_task.size() - 1, static_cast<std::size_t>(bottom / rows_a_task));
            for (auto task = static_cast<std::size_t>(top / rows_a_task); task <= last; ++task) {
                of_task[task].push_back(edge);
            }
        }
    }
    cv::Mat coverage(height, width, CV_8U);
    parallel_for(0, static_cast<int>(of_task.size()), 1, [&](int first, int last) {
        RowSums sums(width);
        for (int task = first; task < last; ++task) {
            const int end = std::min(height, (task + 1) * rows_a_task);
            for (int row = task * rows_a_task; row < end; ++row) {
                sums.clear();
                for (const Edge& edge : of_task[static_cast<std::size_t>(task)]) {
                    add_edge(sums, edge.a, edge.b, row, width);
                }
                std::uint8_t* out = coverage.ptr<std::uint8_t>(row);
                double left = 0;
                for (std::size_t i = 0; i < static_cast<std::size_t>(width); ++i) {
                    out[i] = static_cast<std::uint8_t>(std::lround(255 * even_odd(left + sums.within[i])));
                    left += sums.beyond[i];
                }
            }
        }
    });
    return coverage;
}

}  // namespace puppetwarp
