#include <puppetwarp/mesh/cage_shaper.h>

#include <puppetwarp/mesh/outline.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace puppetwarp {

namespace {

double cross(const Point& a, const Point& b) {
    return a.x() * b.y() - a.y() * b.x();
}

bool holds(const Polyline& polygon, const Point& p) {
    bool inside = false;
    for (std::size_t k = 0; k < polygon.size(); ++k) {
        const Point &a = polygon[k], &b = polygon[k + 1 < polygon.size() ? k + 1 : 0];
        if ((a.y() > p.y()) == (b.y() > p.y())) continue;
        if (p.x() < a.x() + (b.x() - a.x()) * ((p.y() - a.y()) / (b.y() - a.y()))) inside = !inside;
    }
    return inside;
}

// Where the lines from a over b and from d over c meet beyond b and c; nothing when they do not.
std::optional<Point> meeting_beyond(const Point& a, const Point& b, const Point& c, const Point& d) {
    const Point u = b - a, v = c - d;
    const double sine = cross(u, v);
    if (std::abs(sine) <= 1e-6 * u.norm() * v.norm()) return std::nullopt;
    const double s = cross(d - a, v) / sine, t = cross(d - a, u) / sine;
    if (s < 1 || t < 1) return std::nullopt;
    return a + s * u;
}

constexpr double smallest_step_share = 0.02;  // of the clearance
constexpr double least_gain = 1e-6;

}  // namespace

double cage_cost(const Polyline& polygon, const CageRules& rules) {
    double length = 0;
    for (std::size_t k = 0; k < polygon.size(); ++k) {
        length += (polygon[(k + 1) % polygon.size()] - polygon[k]).norm();
    }
    return signed_area(polygon) + rules.edge_cost * length;
}

CageShaper::CageShaper(const Clearance& subject, const Point& within, const CageRules& rules, Polyline start)
    : subject_(subject), within_(within), rules_(rules), corners_(std::move(start)), merges_(corners_.size()) {}

double CageShaper::way_cost(const Point& from, const Point& corner, const Point& to) const {
    return cross(corner - from, to - from) / 2 + rules_.edge_cost * ((corner - from).norm() + (to - corner).norm());
}

bool CageShaper::angle_is_wide(const Point& a, const Point& joint, const Point& b) const {
    const Point u = a - joint, v = b - joint;
    const double length = u.norm() * v.norm();
    return length > 0 && u.dot(v) < std::cos(rules_.min_angle_rad) * length;
}

bool CageShaper::keeps_gaps(const Polyline& changed, std::size_t fresh) const {
    const std::size_t n = changed.size();
    // From the corner before.
    const auto edge = [&](std::size_t k) { return Segment{changed[(k + n - 1) % n], changed[k % n]}; };
    const auto length = [](const Segment& s) { return (s.b - s.a).norm(); };
    for (std::size_t one = 0; one <= fresh; ++one) {
        for (std::size_t ahead = 2; ahead + 1 < n; ++ahead) {
            double gap = rules_.gap;
            // Next but one, edges may be as near as the edge between them is short.
            if (ahead == 2) gap = std::min(gap, 0.5 * length(edge(one + 1)));
            if (ahead + 2 == n) gap = std::min(gap, 0.5 * length(edge(one + n - 1)));
            if (segment_distance(edge(one), edge(one + ahead)) < gap) return false;
        }
    }
    return true;
}

bool CageShaper::allowed(std::size_t first, std::size_t replaced, const Polyline& fresh) const {
    Polyline changed = fresh;
    for (std::size_t k = 0; k < count() - replaced; ++k) changed.push_back(at(first + replaced + k));
    const std::size_t n = changed.size();
    for (std::size_t k = 0; k <= fresh.size(); ++k) {
        if (!subject_.keeps({changed[(k + n - 1) % n], changed[k % n]}, rules_.clearance)) return false;
    }
    for (std::size_t k = n - 1; k < n + fresh.size() + 1; ++k) {
        if (!angle_is_wide(changed[(k - 1) % n], changed[k % n], changed[(k + 1) % n])) return false;
    }
    return keeps_gaps(changed, fresh.size()) && holds(changed, within_);
}

void CageShaper::slide(std::size_t first, std::size_t replaced, double step, Change& change) const {
    const Point from = at(first + count() - 1), to = at(first + replaced);
    const double removed = change.cost - way_cost(from, change.corner, to);
    const double smallest = smallest_step_share * rules_.clearance;
    while (step > smallest) {
        bool moved = false;
        for (int way = 0; way < 8 && !moved; ++way) {
            const double angle = way * std::numbers::pi / 4;
            const Point corner = change.corner + step * Point(std::cos(angle), std::sin(angle));
            const double cost = removed + way_cost(from, corner, to);
            if (cost >= change.cost - least_gain || !allowed(first, replaced, {corner})) continue;
            change = {corner, cost};
            moved = true;
        }
        if (!moved) step /= 2;
    }
}

void CageShaper::put(std::size_t first, std::size_t replaced, const Point& corner) {
    const std::size_t n = count();
    Polyline changed{corner};
    std::vector<Known> merges(1);
    for (std::size_t k = 0; k < n - replaced; ++k) {
        changed.push_back(at(first + replaced + k));
        merges.push_back(merges_[(first + replaced + k) % n]);
    }
    corners_ = std::move(changed);
    merges_ = std::move(merges);
    forget_merges(0, 1);
}

void CageShaper::forget_merges(std::size_t first, std::size_t moved) {
    // A merge of k and k + 1 depends on the corners from k - 2 to k + 3.
    const std::size_t n = count();
    for (std::size_t k = 0; k < moved + 5; ++k) merges_[(first + 3 * n - 3 + k) % n] = {};
}

std::optional<CageShaper::Change> CageShaper::best_merge(std::size_t first) const {
    const Point a = at(first + count() - 1), b = at(first), c = at(first + 1), d = at(first + 2);
    const double removed = way_cost(a, b, c) + cross(c - a, d - a) / 2 + rules_.edge_cost * (d - c).norm();
    const Point along = c - b;
    const Point outward = along.norm() > 0 ? Point(Point(along.y(), -along.x()) / along.norm()) : Point(0, 0);
    std::vector<Point> starts{b, c, 0.5 * (b + c)};
    if (const auto meeting = meeting_beyond(a, b, c, d)) starts.push_back(*meeting);
    for (const double share : {1.0, 2.0, 4.0, 8.0, 16.0}) {
        starts.push_back(0.5 * (b + c) + share * rules_.clearance * outward);
    }
    std::optional<Change> best;
    for (const Point& start : starts) {
        const double cost = way_cost(a, start, d) - removed;
        if ((!best || cost < best->cost) && allowed(first, 2, {start})) best = Change{start, cost};
    }
    if (best) slide(first, 2, std::max(along.norm() / 2, rules_.clearance), *best);
    return best;
}

std::optional<std::pair<std::size_t, CageShaper::Change>> CageShaper::cheapest_merge() {
    for (int round = 0; round < 2; ++round) {
        for (;;) {
            std::optional<std::size_t> best;
            for (std::size_t k = 0; k < count(); ++k) {
                if (!merges_[k].known) merges_[k] = {true, best_merge(k)};
                if (merges_[k].change && (!best || merges_[k].change->cost < merges_[*best].change->cost)) best = k;
            }
            if (!best) break;
            // Corners far along the polygon, but near in the plane, may have come in the way since.
            if (allowed(*best, 2, {merges_[*best].change->corner})) return std::pair(*best, *merges_[*best].change);
            merges_[*best] = {true, best_merge(*best)};
        }
        // And may have gone.
        for (Known& merge : merges_) merge = {};
    }
    return std::nullopt;
}

bool CageShaper::merge_cheapest(double most_cost) {
    if (count() < 4) return false;
    const auto cheapest = cheapest_merge();
    if (!cheapest || cheapest->second.cost > most_cost) return false;
    put(cheapest->first, 2, cheapest->second.corner);
    return true;
}

std::size_t CageShaper::run_to_leave_out(std::size_t first) const {
    const Point& from = at(first);
    double doubled = 0, length = (at(first + 1) - from).norm(), best = -least_gain;
    std::size_t run = 0;
    for (std::size_t skipped = 1; skipped + 3 <= count(); ++skipped) {
        const Point &before = at(first + skipped), &to = at(first + skipped + 1);
        doubled += cross(before - from, to - from);
        length += (to - before).norm();
        const double mouth = (to - from).norm(), cost = rules_.edge_cost * (mouth - length) - doubled / 2;
        // Where an inlet is wider than this, its sides cost less than its area.
        if (mouth > 2 * rules_.edge_cost || cost >= best || !allowed(first + 1, skipped, {})) continue;
        best = cost;
        run = skipped;
    }
    return run;
}

void CageShaper::close_inlets() {
    std::size_t in_vain = 0;
    while (in_vain < count()) {
        // The corner at hand is always the first.
        const std::size_t run = run_to_leave_out(0);
        in_vain = run > 0 ? 0 : in_vain + 1;
        corners_.erase(corners_.begin() + 1, corners_.begin() + 1 + static_cast<std::ptrdiff_t>(run));
        std::rotate(corners_.begin(), corners_.begin() + 1, corners_.end());
    }
    merges_.assign(count(), {});
}

bool CageShaper::reduce(std::size_t most, double worthless) {
    close_inlets();
    while (count() > most) {
        if (!merge_cheapest(std::numeric_limits<double>::infinity())) return false;
        settle_around(0);
    }
    while (merge_cheapest(worthless)) settle_around(0);
    return true;
}

bool CageShaper::settle_corner(std::size_t corner) {
    const std::size_t n = count();
    const Point from = at(corner + n - 1), to = at(corner + 1);
    Change change{at(corner), way_cost(from, at(corner), to)};
    const double before = change.cost;
    slide(corner, 1, std::max((to - from).norm() / 8, rules_.clearance), change);
    if (change.cost >= before - least_gain) return false;
    corners_[corner % n] = change.corner;
    forget_merges(corner, 1);
    return true;
}

Point CageShaper::pulled_in(std::size_t corner, Polyline ends, std::size_t end, const Point& way, double room) const {
    const Point from = ends[end];
    double done = 0;
    for (double step = room / 2; step > smallest_step_share * rules_.clearance; step /= 2) {
        ends[end] = from - (done + step) * way;
        if (allowed(corner, 2, ends)) done += step;
    }
    return from - done * way;
}

bool CageShaper::turn_edge(std::size_t corner) {
    if (count() < 4) return false;
    const Point before = at(corner + count() - 1), after = at(corner + 2);
    const Polyline now{at(corner), at(corner + 1)};
    const std::array<Point, 2> outward{(now[0] - before).normalized(), (now[1] - after).normalized()};
    const std::array<double, 2> room{0.9 * (now[0] - before).norm(), 0.9 * (now[1] - after).norm()};
    const auto cost = [&](const Polyline& ends) {
        return way_cost(before, ends[0], ends[1]) + way_cost(before, ends[1], after) -
               rules_.edge_cost * (ends[1] - before).norm();
    };
    const double before_cost = cost(now);
    double give = std::max((now[1] - now[0]).norm() / 4, rules_.clearance);
    for (; give > 0.1 * rules_.clearance; give /= 2) {
        for (const std::size_t end : {0, 1}) {
            Polyline ends = now;
            ends[end] += give * outward[end];
            ends[1 - end] = pulled_in(corner, ends, 1 - end, outward[1 - end], room[1 - end]);
            if (cost(ends) >= before_cost - least_gain || !allowed(corner, 2, ends)) continue;
            for (const std::size_t k : {0, 1}) corners_[(corner + k) % count()] = ends[k];
            forget_merges(corner, 2);
            return true;
        }
    }
    return false;
}

void CageShaper::settle_around(std::size_t corner) {
    for (const std::size_t k : {corner + count() - 1, corner + 1, corner}) settle_corner(k % count());
}

void CageShaper::settle() {
    constexpr int most_rounds = 50;
    for (int round = 0; round < most_rounds; ++round) {
        bool moved = false;
        for (std::size_t k = 0; k < count(); ++k) moved = settle_corner(k) || moved;
        if (!moved) return;
    }
}

void CageShaper::settle_edges() {
    constexpr int most_rounds = 50;
    for (int round = 0; round < most_rounds; ++round) {
        bool moved = false;
        for (std::size_t k = 0; k < count(); ++k) moved = turn_edge(k) || moved;
        if (!moved) return;
        settle();
    }
}

CageShaper::Change CageShaper::best_split(std::size_t edge) const {
    const Point a = at(edge), b = at(edge + 1);
    const double length = (b - a).norm();
    Change best{0.5 * (a + b), 0};
    for (const double share : {0.2, 0.35, 0.5, 0.65, 0.8}) {
        Change change{a + share * (b - a), 0};
        slide(edge + 1, 0, length / 4, change);
        if (change.cost < best.cost) best = change;
    }
    return best;
}

std::vector<CageShaper::Split> CageShaper::splits() const {
    std::vector<Split> all;
    for (std::size_t edge = 0; edge < count(); ++edge) all.push_back({edge, best_split(edge)});
    std::stable_sort(all.begin(), all.end(),
                     [](const Split& a, const Split& b) { return a.change.cost < b.change.cost; });
    return all;
}

bool CageShaper::trade(double worthless) {
    constexpr std::size_t most_tries = 4;
    std::vector<Split> tries = splits();
    tries.resize(std::min(tries.size(), most_tries));
    const CageShaper before = *this;
    for (const Split& split : tries) {
        put(split.edge + 1, 0, split.change.corner);
        settle_around(0);
        if (merge_cheapest(std::numeric_limits<double>::infinity())) {
            settle();
            if (cost() < before.cost() - worthless / 4) return true;
        }
        corners_ = before.corners_;
        merges_ = before.merges_;
    }
    return false;
}

void CageShaper::refine(std::size_t most, double worthless) {
    while (count() < most) {
        const std::vector<Split> best = splits();
        if (best.front().change.cost > -worthless) break;
        put(best.front().edge + 1, 0, best.front().change.corner);
        settle();
    }
    constexpr int most_trades = 40;
    for (int k = 0; k < most_trades && count() == most && trade(worthless); ++k) {
    }
    settle_edges();
    reduce(most, worthless);
}

}  // namespace puppetwarp
