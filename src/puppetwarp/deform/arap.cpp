#include <puppetwarp/deform/arap.h>

#include <puppetwarp/base/errors.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace puppetwarp {

namespace {

using Complex = std::complex<double>;

// Energies below this share of the squared size are what round-off makes of none.
constexpr double round_off_energy = 1e-18;
constexpr double round_off_share = 1e-12;
constexpr double round_off = 1e-14;
// Handles whose targets are missed by more than this share of the subject's size contradict each other.
constexpr double contradiction = 1e-6;
// How far one step of the way to far targets goes: a share of the subject's size, and an angle.
constexpr double stride = 0.16;
constexpr double stride_rad = 0.5;
constexpr int most_steps = 64;
// A disc that shrank to this share of its size counts as crushed.
constexpr double crushed = 0.1;
// On the way, coming near to the minimum is enough.
constexpr double loose_tolerance = 1e-2;
constexpr int loose_iterations = 12;
// A step of the way that took more iterations has outrun the factor.
constexpr int patience = 3;

double nearest_turn(double angle) {
    return std::remainder(angle, 2 * std::numbers::pi);
}

}  // namespace

ArapDeformer::ArapDeformer(const MethodOptions& options, const TriangleMesh& mesh, const Rig& rig)
    : options_(options),
      rest_(complex_positions(mesh.V)),
      size_(bounding_diagonal(mesh.V)),
      rig_(rig),
      mesh_(mesh),
      binding_(take_hold(mesh, rig, method_name(Method::arap))),
      holds_(arap_holds(binding_)),
      cells_(mesh, options.arap_energy, triangle_stiffness(mesh, rig.stiffness)),
      system_(cells_, holds_, binding_.loose) {
    for (const ArapHold& hold : holds_) rest_means_.push_back(row_value(hold.mean, rest_));
}

std::vector<ArapDeformer::Goal> ArapDeformer::goals_of(const Targets& targets) const {
    std::vector<Goal> goals(holds_.size());
    for (std::size_t h = 0; h < targets.holds.size(); ++h) {
        const HoldTarget& target = targets.holds[h];
        if (target.scale && !target.rotate_rad) {
            throw InvalidInput("handle '" + rig_.handles[static_cast<std::size_t>(binding_.holds[h].handle)].id + "'",
                               "'arap' can set a scale only together with an angle", "give rotate_deg too");
        }
        goals[h].mean = rest_means_[h] + target.move;
        goals[h].turned = target.rotate_rad.has_value();
        goals[h].angle = target.rotate_rad.value_or(0);
        goals[h].scale = target.scale.value_or(0);
    }
    for (std::size_t i = 0; i < binding_.vertices.size(); ++i) {
        goals[targets.holds.size() + i].mean = targets.vertices(static_cast<Eigen::Index>(i));
    }
    return goals;
}

// Where x has the holds now, with the same fields fixed as in `goals`.
std::vector<ArapDeformer::Goal> ArapDeformer::goals_at(const Eigen::VectorXcd& x,
                                                       const std::vector<Goal>& goals) const {
    std::vector<Goal> now = goals;
    for (std::size_t h = 0; h < now.size(); ++h) {
        now[h].mean = row_value(holds_[h].mean, x);
        if (!now[h].turned) continue;
        const Complex turn = row_value(holds_[h].turn, x);
        // The same turn, counted so that the way to the goal is the short one.
        now[h].angle = goals[h].angle - nearest_turn(goals[h].angle - std::arg(turn));
        if (now[h].scale > 0) now[h].scale = std::abs(turn);
    }
    return now;
}

// The rest pose moved rigidly to where the goals fit best: exact when they are a rigid motion.
Eigen::VectorXcd ArapDeformer::rigid_start(const std::vector<Goal>& goals) const {
    const auto count = static_cast<double>(goals.size());
    Complex from = 0, move = 0;
    for (std::size_t h = 0; h < goals.size(); ++h) {
        from += rest_means_[h] / count;
        move += (goals[h].mean - rest_means_[h]) / count;
    }
    Complex correlation = 0;
    for (std::size_t h = 0; h < goals.size(); ++h) {
        const Complex arm = rest_means_[h] - from;
        correlation += std::conj(arm) * (arm + ((goals[h].mean - rest_means_[h]) - move));
        if (goals[h].turned) correlation += holds_[h].radius_px * holds_[h].radius_px * std::polar(1.0, goals[h].angle);
    }
    const double length = std::abs(correlation);
    Complex turn = length > 0 ? correlation / length : Complex(1);
    Eigen::VectorXcd x(rest_.size());
    for (Eigen::Index v = 0; v < x.size(); ++v) x(v) = from + move + turn * (rest_(v) - from);
    return x;
}

int ArapDeformer::steps_between(const std::vector<Goal>& from, const std::vector<Goal>& to) const {
    double strides = 0;
    for (std::size_t h = 0; h < to.size(); ++h) {
        strides = std::max(strides, std::abs(to[h].mean - from[h].mean) / (stride * size_));
        if (!to[h].turned) continue;
        strides = std::max(strides, std::abs(to[h].angle - from[h].angle) / stride_rad);
        if (to[h].scale > 0) strides = std::max(strides, std::abs(std::log(to[h].scale / from[h].scale)) / stride_rad);
    }
    // Written so that an infinite number stays in range.
    return strides < most_steps ? std::max(1, static_cast<int>(std::ceil(strides))) : most_steps;
}

void ArapDeformer::place_fixed(const std::vector<Goal>& goals, Eigen::VectorXcd& x) const {
    for (std::size_t h = 0; h < goals.size(); ++h) {
        if (holds_[h].hard) x(holds_[h].mean.front().first) = goals[h].mean;
    }
}

ArapDeformer::Problem ArapDeformer::problem_of(const std::vector<Goal>& goals, const Eigen::VectorXcd& x) const {
    std::vector<Eigen::Triplet<double>> entries;
    std::vector<double> d;
    const auto add = [&](const ComplexRow& row, double factor, Complex direction, double value) {
        double fixed = 0;
        const auto r = static_cast<int>(d.size());
        for (const auto& [unknown, coefficient] : system_.real_row(row, direction, x, fixed)) {
            entries.emplace_back(r, unknown, factor * coefficient);
        }
        d.push_back(factor * (value - fixed));
    };
    for (std::size_t h = 0; h < goals.size(); ++h) {
        const ArapHold& hold = holds_[h];
        const Goal& goal = goals[h];
        if (hold.hard) continue;
        add(hold.mean, 1, 1, goal.mean.real());
        add(hold.mean, 1, Complex(0, 1), goal.mean.imag());
        if (!goal.turned) continue;
        const Complex ahead = std::polar(1.0, goal.angle);
        add(hold.turn, hold.radius_px, ahead * Complex(0, 1), 0);
        if (goal.scale > 0) add(hold.turn, hold.radius_px, ahead, goal.scale);
    }
    ConstraintSpace::Rows C(static_cast<Eigen::Index>(d.size()), system_.unknowns());
    C.setFromTriplets(entries.begin(), entries.end());
    return {ConstraintSpace(C), Eigen::Map<const Eigen::VectorXd>(d.data(), static_cast<Eigen::Index>(d.size()))};
}

// Whether x is a minimum of no energy that meets its constraints already: rest, and rigid motions of it.
bool ArapDeformer::settled(const Problem& problem, const Eigen::VectorXcd& x) const {
    const Eigen::VectorXd missing = problem.d - problem.constraints.C() * system_.restricted(x);
    return missing.lpNorm<Eigen::Infinity>() <= round_off * size_ &&
           cells_.energy(x) <= round_off_energy * size_ * size_;
}

// Leads the holds from where x has them to the goals, and ends in a minimum there.
ArapMinimum ArapDeformer::lead(const std::vector<Goal>& goals, Eigen::VectorXcd& x, Progress& progress) const {
    const std::vector<Goal> from = goals_at(x, goals);
    const int steps = steps_between(from, goals);
    const double floor = round_off_energy * size_ * size_;
    // Fixed angles change the constraints themselves from step to step, means only where they lead.
    const bool turned = std::any_of(goals.begin(), goals.end(), [](const Goal& goal) { return goal.turned; });
    std::optional<ArapSystem::Factor> factor;
    bool slow = false;
    int spent = 0;
    for (int s = 1;; ++s) {
        const bool last = s == steps;
        const double share = static_cast<double>(s) / steps;
        std::vector<Goal> here = goals;
        for (std::size_t h = 0; h < goals.size() && !last; ++h) {
            here[h].mean = from[h].mean + share * (goals[h].mean - from[h].mean);
            here[h].angle = from[h].angle + share * (goals[h].angle - from[h].angle);
            if (goals[h].scale > 0) here[h].scale = from[h].scale * std::pow(goals[h].scale / from[h].scale, share);
        }
        place_fixed(here, x);
        const Problem problem = problem_of(here, x);
        if (last && s == 1 && settled(problem, x)) return {0, true, {cells_.energy(x)}};
        if (!factor || turned || slow) factor = system_.factorise(x, problem.constraints, true);
        step_onto(system_, cells_, problem.constraints, *factor, problem.d, x);
        const int budget = std::max(0, options_.max_iterations - spent);
        const ArapStop stop{last ? options_.tolerance : loose_tolerance,
                            last ? budget : std::min(budget, loose_iterations), floor};
        ArapMinimum minimum = minimise(system_, cells_, problem.constraints, stop, *factor, x, progress);
        spent += minimum.iterations;
        slow = minimum.iterations > patience;
        if (!last) continue;
        // Steps add up round-off; the handles are met to the last of it.
        system_.add(1, problem.constraints.step_onto(system_.restricted(x), problem.d), x);
        minimum.iterations = spent;
        return minimum;
    }
}

// A fixed angle leaves the turn a line through 0: a disc that was crushed there may have come out on the other side,
// turned by 180 degrees too many. Such goals get the scale of the rest pose.
// \return whether there was one.
bool ArapDeformer::keep_facing(const Eigen::VectorXcd& x, std::vector<Goal>& goals) const {
    bool changed = false;
    for (std::size_t h = 0; h < goals.size(); ++h) {
        if (!goals[h].turned || goals[h].scale > 0) continue;
        if ((row_value(holds_[h].turn, x) * std::polar(1.0, -goals[h].angle)).real() > crushed) continue;
        goals[h].scale = 1;
        changed = true;
    }
    return changed;
}

double ArapDeformer::largest_error(const std::vector<Goal>& goals, const Eigen::VectorXcd& x) const {
    double largest = 0;
    for (std::size_t h = 0; h < goals.size(); ++h) {
        largest = std::max(largest, std::abs(row_value(holds_[h].mean, x) - goals[h].mean));
        if (!goals[h].turned) continue;
        const Complex off = row_value(holds_[h].turn, x) * std::polar(1.0, -goals[h].angle);
        const double error = goals[h].scale > 0 ? std::abs(off - goals[h].scale) : std::abs(off.imag());
        largest = std::max(largest, holds_[h].radius_px * error);
    }
    return largest;
}

Deformation ArapDeformer::deform(const Pose& pose, const Eigen::MatrixX2d* start, Progress& progress) const {
    std::vector<Goal> goals = goals_of(resolve(binding_, mesh_, rig_, pose, AffineUse::no, method_name(Method::arap)));
    if (start != nullptr && (start->rows() != rest_.size() || !start->allFinite())) {
        throw InvalidInput("start", "it is not one finite position for each vertex of the mesh");
    }
    Eigen::VectorXcd x = start != nullptr ? complex_positions(*start) : rigid_start(goals);
    for (Eigen::Index v = 0; v < x.size(); ++v) {
        if (binding_.loose[static_cast<std::size_t>(v)]) x(v) = rest_(v);
    }
    Deformation result;
    result.warnings = binding_.warnings;
    if (system_.unknowns() == 0) {
        place_fixed(goals, x);
        result.energy_history = {cells_.energy(x)};
    } else if (const double energy = cells_.energy(x); start == nullptr && energy <= round_off_energy * size_ * size_ &&
                                                       largest_error(goals, x) <= round_off_share * size_) {
        result.energy_history = {energy};  // a rigid motion: nothing is left to solve
    } else {
        const Eigen::VectorXcd before = x;
        ArapMinimum minimum = lead(goals, x, progress);
        result.iterations = minimum.iterations;
        if (keep_facing(x, goals)) {
            x = before;
            minimum = lead(goals, x, progress);
            result.iterations += minimum.iterations;
        }
        result.converged = minimum.converged;
        result.energy_history = std::move(minimum.energy_history);
    }
    result.energy = result.energy_history.back();
    result.V = point_positions(x);
    result.max_handle_error_px = largest_error(goals, x);
    if (result.max_handle_error_px > contradiction * size_) {
        throw InvalidInput("pose '" + pose.name + "'",
                           "handles that are close together ask for what cannot be met together",
                           "move them apart, or remove one");
    }
    return result;
}

}  // namespace puppetwarp
