#include <puppetwarp/deform/goals.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace puppetwarp {

namespace {

using Complex = std::complex<double>;

// How far one stride goes: a share of the subject's size.
constexpr double stride = 0.16;
constexpr int most_strides = 256;
// Arms shorter than this share of the size have no direction to turn.
constexpr double short_arm = 1e-3;
// The power of the distance by which other handles count for less.
constexpr double nearness = 16;

double nearest_turn(double angle) {
    return std::remainder(angle, 2 * std::numbers::pi);
}

Complex turn_of(const Hold& hold, const Eigen::VectorXcd& x) {
    return hold.turn.empty() ? Complex(1) : row_value(hold.turn, x);
}

}  // namespace

Goals goals_of(const Targets& targets, const Binding& binding, const Eigen::VectorXcd& rest) {
    Goals goals;
    for (std::size_t h = 0; h < binding.holds.size(); ++h) {
        const HoldTarget& target = targets.holds[h];
        HoldGoal goal;
        goal.mean = row_value(binding.holds[h].mean, rest) + target.move;
        if (!binding.holds[h].turn.empty()) {
            goal.angle_rad = target.rotate_rad;
            goal.scale = target.scale;
            if (!goal.angle_rad) goal.way_rad = target.turn_rad;
        }
        goals.holds.push_back(goal);
    }
    goals.vertices = targets.vertices;
    return goals;
}

Goals goals_at(const Eigen::VectorXcd& x, const Binding& binding, const Goals& goals) {
    Goals now = goals;
    for (std::size_t h = 0; h < now.holds.size(); ++h) {
        const Hold& hold = binding.holds[h];
        HoldGoal& goal = now.holds[h];
        goal.mean = row_value(hold.mean, x);
        const Complex turn = turn_of(hold, x);
        if (goal.angle_rad) *goal.angle_rad -= nearest_turn(*goal.angle_rad - std::arg(turn));
        if (goal.way_rad) goal.way_rad = std::arg(turn);
        if (goal.scale) goal.scale = std::abs(turn);
    }
    for (std::size_t k = 0; k < binding.vertices.size(); ++k) {
        now.vertices(static_cast<Eigen::Index>(k)) = x(binding.vertices[k].vertex);
    }
    return now;
}

double largest_error(const Eigen::VectorXcd& x, const Binding& binding, const Goals& goals) {
    double largest = 0;
    for (std::size_t h = 0; h < goals.holds.size(); ++h) {
        const Hold& hold = binding.holds[h];
        const HoldGoal& goal = goals.holds[h];
        largest = std::max(largest, std::abs(row_value(hold.mean, x) - goal.mean));
        const Complex turn = turn_of(hold, x);
        if (goal.angle_rad) {
            const Complex off = turn * std::polar(1.0, -*goal.angle_rad);
            const double error = goal.scale ? std::abs(off - *goal.scale) : std::abs(off.imag());
            largest = std::max(largest, hold.radius_px * error);
        } else if (goal.scale) {
            largest = std::max(largest, hold.radius_px * std::abs(std::abs(turn) - *goal.scale));
        }
    }
    for (std::size_t k = 0; k < binding.vertices.size(); ++k) {
        largest =
            std::max(largest, std::abs(x(binding.vertices[k].vertex) - goals.vertices(static_cast<Eigen::Index>(k))));
    }
    return largest;
}

Eigen::VectorXcd rigid_fit(const Eigen::VectorXcd& rest, const Binding& binding, const Goals& goals) {
    const auto count = static_cast<double>(binding.holds.size() + binding.vertices.size());
    Complex from = 0, move = 0;
    const auto for_each_held = [&](auto&& visit) {
        for (std::size_t h = 0; h < binding.holds.size(); ++h) {
            visit(row_value(binding.holds[h].mean, rest), goals.holds[h].mean);
        }
        for (std::size_t k = 0; k < binding.vertices.size(); ++k) {
            visit(rest(binding.vertices[k].vertex), goals.vertices(static_cast<Eigen::Index>(k)));
        }
    };
    for_each_held([&](const Complex& p, const Complex& q) {
        from += p / count;
        move += (q - p) / count;
    });
    Complex correlation = 0;
    for_each_held([&](const Complex& p, const Complex& q) {
        const Complex arm = p - from;
        correlation += std::conj(arm) * (arm + ((q - p) - move));
    });
    for (std::size_t h = 0; h < binding.holds.size(); ++h) {
        const double radius = binding.holds[h].radius_px;
        if (goals.holds[h].angle_rad) correlation += radius * radius * std::polar(1.0, *goals.holds[h].angle_rad);
    }
    const double length = std::abs(correlation);
    const Complex turn = length > 0 ? correlation / length : Complex(1);
    Eigen::VectorXcd x = rest;
    for (Eigen::Index v = 0; v < x.size(); ++v) {
        if (!binding.loose[static_cast<std::size_t>(v)]) x(v) = from + move + turn * (rest(v) - from);
    }
    return x;
}

Complex GoalPath::Spiral::at(double share) const {
    return centre_from + share * (centre_to - centre_from) + arm * std::exp(share * growth);
}

// About the mean of what other handles hold, the nearest counting nearly alone: that is the joint, when somebody drags.
GoalPath::Spiral GoalPath::spiral_of(std::size_t hold, const Goals& from, const Goals& to,
                                     const Binding& binding) const {
    const Hold& own = binding.holds[hold];
    Complex centre_from = 0, centre_to = 0;
    double sum = 0;
    for (std::size_t k = 0; k < binding.holds.size(); ++k) {
        const Hold& other = binding.holds[k];
        if (other.handle == own.handle || other.component != own.component) continue;
        const double distance = std::max(std::abs(other.at - own.at), short_arm * size_) / size_;
        const double weight = std::pow(distance, -nearness);
        centre_from += weight * from.holds[k].mean;
        centre_to += weight * to.holds[k].mean;
        sum += weight;
    }
    if (sum > 0) {
        centre_from /= sum;
        centre_to /= sum;
    }
    const Complex arm_from = from.holds[hold].mean - centre_from, arm_to = to.holds[hold].mean - centre_to;
    if (sum == 0 || std::abs(arm_from) < short_arm * size_ || std::abs(arm_to) < short_arm * size_) {
        return {from.holds[hold].mean, to.holds[hold].mean, 0, 0};
    }
    double angle = std::arg(arm_to / arm_from);
    if (to.holds[hold].way_rad) {
        const double way = *to.holds[hold].way_rad - *from.holds[hold].way_rad;
        angle = way - nearest_turn(way - angle);
    }
    return {centre_from, centre_to, arm_from, Complex(std::log(std::abs(arm_to) / std::abs(arm_from)), angle)};
}

GoalPath::GoalPath(const Binding& binding, const Goals& from, const Goals& to, double size, Way way)
    : from_(from), to_(to), size_(size), way_(way) {
    for (std::size_t h = 0; h < to.holds.size(); ++h) {
        holds_.push_back(way == Way::straight ? Spiral{from.holds[h].mean, to.holds[h].mean, 0, 0}
                                              : spiral_of(h, from, to, binding));
        widest_turn_ = std::max(widest_turn_, std::abs(holds_.back().growth.imag()));
    }
    // A handle's vertices turn together, about their own centre.
    std::vector<Complex> centre_from, centre_to, turn;
    std::vector<double> count;
    const auto at = [](int handle) { return static_cast<std::size_t>(handle); };
    for (const HeldVertex& held : binding.vertices) {
        const std::size_t needed = at(held.handle) + 1;
        if (count.size() < needed) {
            count.resize(needed);
            centre_from.resize(needed);
            centre_to.resize(needed);
            turn.resize(needed);
        }
        count[at(held.handle)] += 1;
    }
    for (std::size_t k = 0; k < binding.vertices.size(); ++k) {
        const std::size_t h = at(binding.vertices[k].handle);
        centre_from[h] += from.vertices(static_cast<Eigen::Index>(k)) / count[h];
        centre_to[h] += to.vertices(static_cast<Eigen::Index>(k)) / count[h];
    }
    for (std::size_t k = 0; k < binding.vertices.size(); ++k) {
        const std::size_t h = at(binding.vertices[k].handle);
        const auto i = static_cast<Eigen::Index>(k);
        turn[h] += (to.vertices(i) - centre_to[h]) * std::conj(from.vertices(i) - centre_from[h]);
    }
    for (std::size_t k = 0; k < binding.vertices.size(); ++k) {
        const std::size_t h = at(binding.vertices[k].handle);
        const auto i = static_cast<Eigen::Index>(k);
        const Complex arm_from = from.vertices(i) - centre_from[h], arm_to = to.vertices(i) - centre_to[h];
        if (std::abs(arm_from) < 1e-12 * size || std::abs(arm_to) < 1e-12 * size || std::abs(turn[h]) == 0) {
            vertices_.push_back({from.vertices(i), to.vertices(i), 0, 0});
            continue;
        }
        const double common = std::arg(turn[h]);
        const double angle = common - nearest_turn(common - std::arg(arm_to / arm_from));
        widest_turn_ = std::max(widest_turn_, std::abs(angle));
        vertices_.push_back(
            {centre_from[h], centre_to[h], arm_from, Complex(std::log(std::abs(arm_to) / std::abs(arm_from)), angle)});
    }
}

double GoalPath::strongest_squeeze() const {
    double strongest = 1;
    for (std::size_t h = 0; h < holds_.size(); ++h) strongest = std::min(strongest, squeeze(h));
    return strongest;
}

int GoalPath::strides(double stride_rad) const {
    double strides = 0;
    const auto count_spiral = [&](const Spiral& spiral) {
        const double arm = std::abs(spiral.arm) * std::max(1.0, std::exp(spiral.growth.real()));
        const double length = std::abs(spiral.centre_to - spiral.centre_from) + arm * std::abs(spiral.growth);
        strides = std::max({strides, length / (stride * size_), std::abs(spiral.growth.imag()) / stride_rad});
    };
    for (const Spiral& spiral : holds_) count_spiral(spiral);
    for (const Spiral& spiral : vertices_) count_spiral(spiral);
    for (std::size_t h = 0; h < to_.holds.size(); ++h) {
        const HoldGoal& from = from_.holds[h];
        const HoldGoal& to = to_.holds[h];
        if (to.angle_rad) strides = std::max(strides, std::abs(*to.angle_rad - *from.angle_rad) / stride_rad);
        if (to.way_rad) strides = std::max(strides, std::abs(*to.way_rad - *from.way_rad) / stride_rad);
        if (to.scale) strides = std::max(strides, std::abs(std::log(*to.scale / *from.scale)) / stride_rad);
    }
    // Written so that an infinite number stays in range.
    return strides < most_strides ? std::max(1, static_cast<int>(std::ceil(strides))) : most_strides;
}

Goals GoalPath::held_end() const {
    Goals end = to_;
    for (HoldGoal& goal : end.holds) {
        if (goal.way_rad) goal.angle_rad = goal.way_rad;
    }
    return end;
}

Goals GoalPath::at(double share) const {
    if (share >= 1) return to_;
    Goals here = to_;
    for (std::size_t h = 0; h < here.holds.size(); ++h) {
        const HoldGoal& from = from_.holds[h];
        const HoldGoal& to = to_.holds[h];
        HoldGoal& goal = here.holds[h];
        goal.mean = holds_[h].at(share);
        if (to.angle_rad) goal.angle_rad = *from.angle_rad + share * (*to.angle_rad - *from.angle_rad);
        if (to.way_rad && way_ != Way::following)
            goal.angle_rad = *from.way_rad + share * (*to.way_rad - *from.way_rad);
        if (to.scale) goal.scale = *from.scale * std::pow(*to.scale / *from.scale, share);
    }
    for (std::size_t k = 0; k < vertices_.size(); ++k) {
        here.vertices(static_cast<Eigen::Index>(k)) = vertices_[k].at(share);
    }
    return here;
}

}  // namespace puppetwarp
