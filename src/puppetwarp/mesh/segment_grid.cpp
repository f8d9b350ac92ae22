#include <puppetwarp/mesh/segment_grid.h>

#include <algorithm>
#include <cmath>

namespace puppetwarp {

namespace {

double cross(const Point& a, const Point& b) {
    return a.x() * b.y() - a.y() * b.x();
}

// -1, 0, 1: which side of the line a-b the point c is on; 0 when rounding could have decided.
int side(const Point& a, const Point& b, const Point& c) {
    const double left = (b.x() - a.x()) * (c.y() - a.y());
    const double right = (b.y() - a.y()) * (c.x() - a.x());
    const double determinant = left - right;
    const double doubt = 1e-15 * (std::abs(left) + std::abs(right));
    return determinant > doubt ? 1 : determinant < -doubt ? -1 : 0;
}

bool within_box(const Segment& s, const Point& p) {
    return (p.array() >= s.a.array().min(s.b.array())).all() && (p.array() <= s.a.array().max(s.b.array())).all();
}

// Whether t leaves the common endpoint `joint` along s.
bool fold_back(const Point& joint, const Point& s_end, const Point& t_end) {
    return side(joint, s_end, t_end) == 0 && (s_end - joint).dot(t_end - joint) > 0;
}

struct Grid {
    Point origin;
    double cell;
    int columns, rows;

    int column(double x) const { return std::clamp(static_cast<int>((x - origin.x()) / cell), 0, columns - 1); }
    int row(double y) const { return std::clamp(static_cast<int>((y - origin.y()) / cell), 0, rows - 1); }
};

// Cells about as long as the mean segment, but no more of them than a few for each segment.
Grid grid_over(const std::vector<Segment>& segments) {
    Point low = segments.front().a, high = low;
    double length = 0;
    for (const Segment& s : segments) {
        low = low.cwiseMin(s.a).cwiseMin(s.b);
        high = high.cwiseMax(s.a).cwiseMax(s.b);
        length += (s.b - s.a).lpNorm<1>();
    }
    const double count = static_cast<double>(segments.size());
    const Point size = high - low;
    const double cell =
        std::max({length / count, std::sqrt(size.x() * size.y() / count / 4), size.maxCoeff() / 30000, 1e-300});
    return {low, cell, static_cast<int>(size.x() / cell) + 1, static_cast<int>(size.y() / cell) + 1};
}

// Calls visit(cell) for each cell of the grid that the segment may touch, row by row.
template <class Visit>
void cells_of(const Grid& grid, const Segment& s, const Visit& visit) {
    const Point& top = s.a.y() <= s.b.y() ? s.a : s.b;
    const Point& bottom = s.a.y() <= s.b.y() ? s.b : s.a;
    const double slope = bottom.y() > top.y() ? (bottom.x() - top.x()) / (bottom.y() - top.y()) : 0;
    const double slack = 1e-9 * grid.cell;
    const int last_row = grid.row(bottom.y());
    for (int row = grid.row(top.y()); row <= last_row; ++row) {
        const double y0 = std::max(top.y(), grid.origin.y() + row * grid.cell - slack);
        const double y1 = std::min(bottom.y(), grid.origin.y() + (row + 1) * grid.cell + slack);
        double x0 = top.x() + (y0 - top.y()) * slope, x1 = top.x() + (y1 - top.y()) * slope;
        if (!(bottom.y() > top.y())) {
            x0 = top.x();
            x1 = bottom.x();
        }
        const int last_column = grid.column(std::max(x0, x1) + slack);
        for (int column = grid.column(std::min(x0, x1) - slack); column <= last_column; ++column) {
            visit(static_cast<std::size_t>(row) * static_cast<std::size_t>(grid.columns) +
                  static_cast<std::size_t>(column));
        }
    }
}

}  // namespace

bool segments_meet(const Segment& s, const Segment& t) {
    if (s.a == t.a) return s.b == t.b || fold_back(s.a, s.b, t.b);
    if (s.a == t.b) return s.b == t.a || fold_back(s.a, s.b, t.a);
    if (s.b == t.a) return fold_back(s.b, s.a, t.b);
    if (s.b == t.b) return fold_back(s.b, s.a, t.a);
    const int s_a = side(t.a, t.b, s.a), s_b = side(t.a, t.b, s.b);
    const int t_a = side(s.a, s.b, t.a), t_b = side(s.a, s.b, t.b);
    if (s_a * s_b < 0 && t_a * t_b < 0) return true;
    return (s_a == 0 && within_box(t, s.a)) || (s_b == 0 && within_box(t, s.b)) || (t_a == 0 && within_box(s, t.a)) ||
           (t_b == 0 && within_box(s, t.b));
}

Point meeting_point(const Segment& s, const Segment& t) {
    for (const Point* shared : {&s.a, &s.b}) {
        if (*shared == t.a || *shared == t.b) return *shared;
    }
    const double sine = cross(s.b - s.a, t.b - t.a);
    if (sine == 0) return 0.5 * (s.a + s.b);
    return s.a + (s.b - s.a) * std::clamp(cross(t.a - s.a, t.b - t.a) / sine, 0.0, 1.0);
}

std::vector<std::pair<std::size_t, std::size_t>> meeting_pairs(const std::vector<Segment>& segments) {
    std::vector<std::pair<std::size_t, std::size_t>> pairs;
    if (segments.empty()) return pairs;
    const Grid grid = grid_over(segments);
    std::vector<std::size_t> first(static_cast<std::size_t>(grid.columns) * static_cast<std::size_t>(grid.rows) + 1, 0);
    for (const Segment& s : segments) cells_of(grid, s, [&](std::size_t cell) { ++first[cell + 1]; });
    for (std::size_t cell = 1; cell < first.size(); ++cell) first[cell] += first[cell - 1];
    std::vector<std::size_t> members(first.back());
    std::vector<std::size_t> next(first.begin(), first.end() - 1);
    for (std::size_t k = 0; k < segments.size(); ++k) {
        cells_of(grid, segments[k], [&](std::size_t cell) { members[next[cell]++] = k; });
    }
    for (std::size_t cell = 0; cell + 1 < first.size(); ++cell) {
        for (std::size_t m = first[cell]; m < first[cell + 1]; ++m) {
            for (std::size_t n = m + 1; n < first[cell + 1]; ++n) {
                if (segments_meet(segments[members[m]], segments[members[n]])) {
                    pairs.emplace_back(members[m], members[n]);
                }
            }
        }
    }
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    return pairs;
}

}  // namespace puppetwarp
