#include <puppetwarp/deform/variational_problem.h>

#include <puppetwarp/deform/arap_cells.h>
#include <puppetwarp/deform/element_energy.h>
#include <puppetwarp/deform/smooth_arap_energy.h>

#include <algorithm>
#include <cmath>

namespace puppetwarp {

namespace {

using Complex = std::complex<double>;

// Springs of `fold-free`: of the order of 0.005 thousandths of the subject's size off.   ALGORITHMS.md section 4.
constexpr double fold_free_penalty = 1e4;
// Default bending length, against the subject's size.
constexpr double bending_share = 0.02;
// How much of the Laplacian `smooth-arap`'s constant metric has beside the bending: local rotations cost nothing in the
// energy and all in the Laplacian.
constexpr double laplacian_share = 0.2;

// A scale is met when it is as near as this; springs leave what they leave.
constexpr double settled_scale = 1e-10;

}  // namespace

VariationalProblem::VariationalProblem(const MethodOptions& options, const TriangleMesh& mesh, const Rig& rig)
    : options_(options),
      mesh_(mesh),
      rig_(rig),
      rest_(complex_positions(mesh.V)),
      size_(bounding_diagonal(mesh.V)),
      binding_(take_hold(mesh, rig, method_name(options.method))),
      energy_(make_energy(mesh)),
      free_(binding_.loose),
      component_(vertex_components(mesh)) {
    free_.flip();
    for (const Hold& hold : binding_.holds) {
        rows_.push_back(hold.mean);
        rows_.push_back(hold.turn);
        for (auto& entry : rows_.back()) entry.second *= hold.radius_px;
    }
    for (const HeldVertex& held : binding_.vertices) {
        if (guards_folds()) {
            sprung_.push_back(held.vertex);
        } else {
            free_[static_cast<std::size_t>(held.vertex)] = false;
        }
    }
    unknowns_ = std::count(free_.begin(), free_.end(), true);
    choose_grounds(mesh);
    if (options_.method == Method::smooth_arap && unknowns_ > 0) {
        const auto& smooth = static_cast<const SmoothArapEnergy&>(*energy_);
        const SparseMatrix laplacian = cotangent_stiffness(mesh, triangle_stiffness(mesh, rig.stiffness));
        constant_ = factor_quadratic(4 * laplacian_share * laplacian + smooth.bending_hessian(), free_, grounds_);
    }
}

std::unique_ptr<Energy> VariationalProblem::make_energy(const TriangleMesh& mesh) const {
    const Eigen::VectorXd stiffness = triangle_stiffness(mesh, rig_.stiffness);
    switch (options_.method) {
        case Method::fold_free: return make_symmetric_dirichlet(mesh, stiffness);
        case Method::smooth_arap:
            return std::make_unique<SmoothArapEnergy>(mesh, stiffness,
                                                      options_.bending_length_px.value_or(bending_share * size_));
        default: break;
    }
    if (options_.arap_energy == ArapEnergy::elements) return make_element_arap(mesh, stiffness);
    return std::make_unique<ArapCells>(mesh, options_.arap_energy, stiffness);
}

// Two vertices far apart in each component that no two fixed vertices hold: with them the Hessian is definite, whatever
// the handles are.
void VariationalProblem::choose_grounds(const TriangleMesh& mesh) {
    const int components = component_.size() > 0 ? component_.maxCoeff() + 1 : 0;
    std::vector<std::vector<int>> free_of(static_cast<std::size_t>(components));
    std::vector<int> fixed(static_cast<std::size_t>(components));
    for (int v = 0; v < component_.size(); ++v) {
        const auto c = static_cast<std::size_t>(component_(v));
        if (free_[static_cast<std::size_t>(v)]) {
            free_of[c].push_back(v);
        } else if (!binding_.loose[static_cast<std::size_t>(v)]) {
            ++fixed[c];
        }
    }
    std::vector<std::vector<Complex>> places(static_cast<std::size_t>(components));
    const auto note = [&](int component, const Complex& at) {
        auto& known = places[static_cast<std::size_t>(component)];
        if (known.size() > 1) return;
        if (known.empty() || std::abs(known.front() - at) > one_place * size_) known.push_back(at);
    };
    for (const Hold& hold : binding_.holds) note(hold.component, hold.at);
    for (const HeldVertex& held : binding_.vertices) note(component_(held.vertex), rest_(held.vertex));
    for (const auto& known : places) component_places_.push_back(static_cast<int>(known.size()));

    const auto farthest = [&](const std::vector<int>& vertices, const Complex& from) {
        return *std::max_element(vertices.begin(), vertices.end(),
                                 [&](int a, int b) { return std::norm(rest_(a) - from) < std::norm(rest_(b) - from); });
    };
    for (std::size_t c = 0; c < free_of.size(); ++c) {
        if (free_of[c].empty() || fixed[c] > 1) continue;
        const int first = farthest(free_of[c], rest_(free_of[c].front()));
        const int second = farthest(free_of[c], rest_(first));
        grounds_.vertices.push_back(first);
        if (second != first) grounds_.vertices.push_back(second);
    }
    const SparseMatrix laplacian = cotangent_stiffness(mesh);
    grounds_.stiffness = 2 * laplacian.diagonal().mean();
}

Goals VariationalProblem::goals(const Pose& pose) const {
    return goals_of(resolve(binding_, mesh_, rig_, pose, AffineUse::no, method_name(options_.method)), binding_, rest_);
}

Objective VariationalProblem::objective(const Goals& goals, const Eigen::VectorXcd& x) const {
    Objective objective{*energy_, free_, rows_, guards_folds() ? fold_free_penalty : 0, {}, sprung_, {}};
    aim(objective, goals, x);
    return objective;
}

void VariationalProblem::aim(Objective& objective, const Goals& goals, const Eigen::VectorXcd& x) const {
    objective.conditions.clear();
    for (std::size_t h = 0; h < goals.holds.size(); ++h) {
        const Hold& hold = binding_.holds[h];
        const HoldGoal& goal = goals.holds[h];
        const int mean = 2 * static_cast<int>(h);
        const int turn = mean + 1;
        objective.conditions.push_back({mean, 1, goal.mean.real()});
        objective.conditions.push_back({mean, Complex(0, 1), goal.mean.imag()});
        if (goal.angle_rad) {
            const Complex ahead = std::polar(1.0, *goal.angle_rad);
            objective.conditions.push_back({turn, Complex(0, 1) * ahead, 0});
            if (goal.scale) objective.conditions.push_back({turn, ahead, *goal.scale * hold.radius_px});
        } else if (goal.scale) {
            const Complex now = row_value(hold.turn, x);
            const double length = std::abs(now);
            objective.conditions.push_back(
                {turn, length > 0 ? now / length : Complex(1), *goal.scale * hold.radius_px});
        }
    }
    if (guards_folds()) objective.anchors = goals.vertices;
}

void VariationalProblem::place_held(const Goals& goals, Eigen::VectorXcd& x) const {
    if (guards_folds()) return;
    for (std::size_t k = 0; k < binding_.vertices.size(); ++k) {
        x(binding_.vertices[k].vertex) = goals.vertices(static_cast<Eigen::Index>(k));
    }
}

bool VariationalProblem::scales_settled(const Goals& goals, const Eigen::VectorXcd& x) const {
    for (std::size_t h = 0; h < goals.holds.size(); ++h) {
        const HoldGoal& goal = goals.holds[h];
        if (!goal.scale || goal.angle_rad || guards_folds()) continue;
        if (std::abs(std::abs(row_value(binding_.holds[h].turn, x)) - *goal.scale) > settled_scale) return false;
    }
    return true;
}

const HessianFactory& VariationalProblem::factory() const {
    std::call_once(factory_made_, [&] {
        const VertexSprings springs{sprung_, guards_folds() ? fold_free_penalty : 0};
        factory_ = std::make_unique<const HessianFactory>(*energy_, free_, grounds_, springs);
    });
    return *factory_;
}

std::shared_ptr<ConstrainedMetric> VariationalProblem::metric(const Eigen::VectorXcd& x,
                                                              const Objective& objective) const {
    if (!constant_) return exact_metric(x, objective);
    auto metric = std::make_shared<ConstrainedMetric>(constant_, rest_.size(), grounds_, objective.penalty);
    choose(*metric, objective);
    return metric;
}

std::shared_ptr<ConstrainedMetric> VariationalProblem::exact_metric(const Eigen::VectorXcd& x,
                                                                    const Objective& objective) const {
    auto metric =
        std::make_shared<ConstrainedMetric>(factory().factorise(x), rest_.size(), grounds_, objective.penalty);
    choose(*metric, objective);
    return metric;
}

void VariationalProblem::choose(ConstrainedMetric& metric, const Objective& objective) const {
    metric.choose(rows_, objective.conditions, leaves_rigid_freedom(objective));
}

// Whether some component is held in less than two places and at no angle.
bool VariationalProblem::leaves_rigid_freedom(const Objective& objective) const {
    std::vector<int> holding = component_places_;
    for (const Condition& condition : objective.conditions) {
        if (condition.row % 2 == 0) continue;
        const auto h = static_cast<std::size_t>(condition.row / 2);
        ++holding[static_cast<std::size_t>(binding_.holds[h].component)];
    }
    return std::any_of(holding.begin(), holding.end(), [](int count) { return count == 1; });
}

}  // namespace puppetwarp
