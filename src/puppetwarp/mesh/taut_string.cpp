#include <puppetwarp/mesh/taut_string.h>

#include <cmath>

namespace puppetwarp {

namespace {

constexpr std::size_t smallest_taut_contour = 16;  // gates; a speck is taken as it is

double cross(const Point& a, const Point& b) {
    return a.x() * b.y() - a.y() * b.x();
}

// One wall of the funnel: the tightest point seen so far and the gate it belongs to.
struct Wall {
    Point at;
    std::size_t step;
};

// Shortest way from `start` at gate `first` once round to `start` again; the bends on it, without start and end.
std::vector<Bend> pull(const std::vector<Gate>& gates, std::size_t first, const Point& start) {
    const std::size_t count = gates.size();
    std::vector<Bend> bends;
    Point apex = start;
    std::size_t apex_step = 0;
    Wall inner{start, 0}, outer{start, 0};
    // Moves one wall inwards; true when it met the other wall, which then is a bend. `side` is 1 for the inner wall.
    const auto tighten = [&](Wall& wall, const Wall& other, const Point& point, std::size_t step, double side) {
        if (side * cross(wall.at - apex, point - apex) > 0) return false;
        if (wall.at == apex || side * cross(other.at - apex, point - apex) > 0) {
            wall = {point, step};
            return false;
        }
        return true;
    };
    for (std::size_t step = 1; step <= count; ++step) {
        const Gate& gate = gates[(first + step) % count];
        const bool last = step == count;
        Wall* bend = nullptr;
        if (tighten(inner, outer, last ? start : gate.inner, step, 1)) {
            bend = &outer;
        } else if (tighten(outer, inner, last ? start : gate.outer, step, -1)) {
            bend = &inner;
        }
        if (bend == nullptr || bend->step <= apex_step) continue;
        apex = bend->at;
        apex_step = bend->step;
        if (apex_step > 0 && apex_step < count) bends.push_back({(first + apex_step) % count, apex});
        inner = outer = {apex, apex_step};
        step = apex_step;
    }
    return bends;
}

struct Line {
    Point through, direction;
    Point nearest(const Point& point) const { return through + direction * direction.dot(point - through); }
};

// The line of least squared distances to the middles of the gates from one bend to the next.
Line fitted_line(const std::vector<Gate>& gates, const Bend& from, const Bend& to) {
    const std::size_t count = gates.size();
    const std::size_t steps = (to.gate + count - from.gate) % count;
    Point mean = Point::Zero();
    for (std::size_t k = 0; k <= steps; ++k) mean += gates[(from.gate + k) % count].middle;
    mean /= static_cast<double>(steps + 1);
    Point direction = to.at - from.at;
    if (steps >= 3) {
        double xx = 0, xy = 0, yy = 0;
        for (std::size_t k = 0; k <= steps; ++k) {
            const Point d = gates[(from.gate + k) % count].middle - mean;
            xx += d.x() * d.x();
            xy += d.x() * d.y();
            yy += d.y() * d.y();
        }
        const double angle = 0.5 * std::atan2(2 * xy, xx - yy);
        direction = {std::cos(angle), std::sin(angle)};
    }
    const double length = direction.norm();
    return {mean, length > 0 ? Point(direction / length) : Point(1, 0)};
}

// Where two pieces meet: their crossing if that is near, else between them.
Point joint(const Line& before, const Line& after, const Point& near) {
    const double sine = cross(before.direction, after.direction);
    if (std::abs(sine) > 1e-3) {
        Point crossing =
            before.through + before.direction * (cross(after.through - before.through, after.direction) / sine);
        if ((crossing - near).squaredNorm() <= 1) return crossing;
    }
    return 0.5 * (before.nearest(near) + after.nearest(near));
}

}  // namespace

std::vector<Bend> taut_string(const std::vector<Gate>& gates) {
    if (gates.size() < smallest_taut_contour) return {};
    // Any point of the curve serves to start from; one of its bends surely is on the closed string too.
    const std::vector<Bend> trial = pull(gates, 0, gates[0].middle);
    if (trial.size() < 3) return {};
    const Bend& start = trial[trial.size() / 2];
    std::vector<Bend> bends{start};
    for (const Bend& bend : pull(gates, start.gate, start.at)) {
        if (bend.gate != bends.back().gate) bends.push_back(bend);
    }
    return bends;
}

Polyline straightened(const std::vector<Gate>& gates) {
    const std::vector<Bend> bends = taut_string(gates);
    Polyline polygon;
    if (bends.size() < 3) {
        for (const Gate& gate : gates) polygon.push_back(gate.middle);
        return polygon;
    }
    std::vector<Line> lines;
    for (std::size_t k = 0; k < bends.size(); ++k) {
        lines.push_back(fitted_line(gates, bends[k], bends[(k + 1) % bends.size()]));
    }
    for (std::size_t k = 0; k < bends.size(); ++k) {
        const Gate& gate = gates[bends[k].gate];
        const Line& before = lines[(k + lines.size() - 1) % lines.size()];
        polygon.push_back(gate.wide ? joint(before, lines[k], gate.middle) : gate.middle);
    }
    return polygon;
}

}  // namespace puppetwarp
