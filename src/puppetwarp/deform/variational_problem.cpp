#include <puppetwarp/deform/variational_problem.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/deform/arap_energy.h>
#include <puppetwarp/deform/element_energy.h>
#include <puppetwarp/deform/smooth_arap_energy.h>
#include <puppetwarp/mesh/distortion.h>

#include <algorithm>
#include <cmath>

namespace puppetwarp {

namespace {

using Complex = std::complex<double>;

// Springs of `fold-free`: of the order of 0.005 thousandths of the subject's size off.   ALGORITHMS.md section 4.
constexpr double fold_free_penalty = 1e4;
// Default bending length, against the subject's size.
constexpr double bending_share = 0.01;
constexpr int longest_bending = 100;
// How much of the Laplacian `smooth-arap`'s constant metric has beside the bending: local rotations cost nothing in the
// energy and all in the Laplacian.
constexpr double laplacian_share = 0.2;

// Stretch that a limb has that was led the wrong way; some that were led right have it too.
constexpr double natural_stretch = 2.5;

// A scale is met when it is as near as this; springs leave more.
constexpr double settled_scale = 1e-10;
constexpr double settled_sprung_scale = 1e-3;

double bending_length(const MethodOptions& options, const TriangleMesh& mesh) {
    const double length = options.bending_length_px.value_or(usual_bending_length_px(mesh));
    if (length > 0 && length <= longest_bending * bounding_diagonal(mesh.V)) return length;
    throw InvalidInput("bending_length_px",
                       "must be above 0 and at most " + std::to_string(longest_bending) + " times the subject's size");
}

std::unique_ptr<const Energy> make_energy(const MethodOptions& options, const TriangleMesh& mesh,
                                          const Eigen::VectorXd& stiffness) {
    switch (options.method) {
        case Method::fold_free: return make_symmetric_dirichlet(mesh, stiffness);
        case Method::smooth_arap:
            return std::make_unique<SmoothArapEnergy>(mesh, stiffness, bending_length(options, mesh));
        default: break;
    }
    return make_arap_energy(options.arap_energy, mesh, stiffness);
}

}  // namespace

double usual_bending_length_px(const TriangleMesh& mesh) {
    return bending_share * bounding_diagonal(mesh.V);
}

bool is_variational(Method method) {
    return method == Method::arap || method == Method::smooth_arap || method == Method::fold_free;
}

VariationalProblem::Subject::Subject(const MethodOptions& method, const TriangleMesh& triangles,
                                     Eigen::VectorXd factors)
    : options(method),
      mesh(triangles),
      discs(mesh),
      stiffness(std::move(factors)),
      rest(complex_positions(mesh.V)),
      size(bounding_diagonal(mesh.V)),
      component(vertex_components(mesh)),
      energy(make_energy(options, mesh, stiffness)) {}

VariationalProblem::VariationalProblem(const MethodOptions& options, const TriangleMesh& mesh, const Rig& rig)
    : rig_(rig), subject_(std::make_shared<const Subject>(options, mesh, triangle_stiffness(mesh, rig.stiffness))) {
    take_hold_of_subject();
    const std::shared_ptr<Factors> factors = free_vertices();
    prepare(*factors);
    factors_ = factors;
}

VariationalProblem::VariationalProblem(const VariationalProblem& before, const Rig& rig)
    : rig_(rig), subject_(before.subject_) {
    const Eigen::VectorXd stiffness = triangle_stiffness(subject_->mesh, rig.stiffness);
    if (stiffness.size() != subject_->stiffness.size() || stiffness != subject_->stiffness) {
        subject_ = std::make_shared<const Subject>(subject_->options, subject_->mesh, stiffness);
    }
    take_hold_of_subject();
    const std::shared_ptr<Factors> factors = free_vertices();
    const bool same = subject_ == before.subject_ && factors->free == before.factors_->free &&
                      factors->sprung == before.factors_->sprung;
    if (!same) prepare(*factors);
    factors_ = same ? before.factors_ : factors;
}

void VariationalProblem::take_hold_of_subject() {
    binding_ = take_hold(subject_->discs, subject_->mesh, rig_, method_name(options().method));
    for (const Hold& hold : binding_.holds) {
        rows_.push_back(hold.mean);
        rows_.push_back(hold.turn);
        for (auto& entry : rows_.back()) entry.second *= hold.radius_px;
    }
    std::vector<std::vector<Complex>> places(static_cast<std::size_t>(subject_->component.maxCoeff()) + 1);
    const auto note = [&](int component, const Complex& at) {
        auto& known = places[static_cast<std::size_t>(component)];
        if (known.size() > 1) return;
        if (known.empty() || std::abs(known.front() - at) > one_place * size()) known.push_back(at);
    };
    for (const Hold& hold : binding_.holds) note(hold.component, hold.at);
    for (const HeldVertex& held : binding_.vertices) note(subject_->component(held.vertex), rest()(held.vertex));
    for (const auto& known : places) component_places_.push_back(static_cast<int>(known.size()));
}

// Nothing but the question which vertices are free.
std::shared_ptr<VariationalProblem::Factors> VariationalProblem::free_vertices() const {
    auto factors = std::make_shared<Factors>();
    factors->subject = subject_;
    factors->free = binding_.loose;
    factors->free.flip();
    for (const HeldVertex& held : binding_.vertices) {
        if (guards_folds()) {
            factors->sprung.push_back(held.vertex);
        } else {
            factors->free[static_cast<std::size_t>(held.vertex)] = false;
        }
    }
    factors->unknowns = std::count(factors->free.begin(), factors->free.end(), true);
    return factors;
}

void VariationalProblem::prepare(Factors& factors) const {
    factors.grounds = grounds_for(factors.free);
    if (options().method != Method::smooth_arap || factors.unknowns == 0) return;
    const auto& smooth = static_cast<const SmoothArapEnergy&>(*subject_->energy);
    const SparseMatrix laplacian = cotangent_stiffness(subject_->mesh, subject_->stiffness);
    factors.constant =
        factor_quadratic(4 * laplacian_share * laplacian + smooth.bending_hessian(), factors.free, factors.grounds);
}

// Two vertices far apart in each component that no two fixed vertices hold: with them the Hessian is definite, whatever
// the handles are.
VertexSprings VariationalProblem::grounds_for(const std::vector<bool>& free) const {
    const Eigen::VectorXi& component = subject_->component;
    const auto components = static_cast<std::size_t>(component.maxCoeff()) + 1;
    std::vector<std::vector<int>> free_of(components);
    std::vector<int> fixed(components);
    for (int v = 0; v < component.size(); ++v) {
        const auto c = static_cast<std::size_t>(component(v));
        if (free[static_cast<std::size_t>(v)]) {
            free_of[c].push_back(v);
        } else {
            ++fixed[c];
        }
    }
    const auto farthest = [&](const std::vector<int>& vertices, const Complex& from) {
        return *std::max_element(vertices.begin(), vertices.end(), [&](int a, int b) {
            return std::norm(rest()(a) - from) < std::norm(rest()(b) - from);
        });
    };
    VertexSprings grounds;
    for (std::size_t c = 0; c < components; ++c) {
        if (free_of[c].empty() || fixed[c] > 1) continue;
        const int first = farthest(free_of[c], rest()(free_of[c].front()));
        const int second = farthest(free_of[c], rest()(first));
        grounds.vertices.push_back(first);
        if (second != first) grounds.vertices.push_back(second);
    }
    const SparseMatrix laplacian = cotangent_stiffness(subject_->mesh);
    grounds.stiffness = 2 * laplacian.diagonal().mean();
    return grounds;
}

Goals VariationalProblem::goals(const Pose& pose) const {
    return goals_of(resolve(binding_, subject_->mesh, rig_, pose, AffineUse::no, method_name(options().method)),
                    binding_, rest());
}

// Springs as much stiffer as the stiffest part: the handles win also there.
double VariationalProblem::spring_stiffness() const {
    if (!guards_folds()) return 0;
    const Eigen::VectorXd& stiffness = subject_->stiffness;
    return fold_free_penalty * (stiffness.size() > 0 ? std::max(1.0, stiffness.maxCoeff()) : 1.0);
}

Objective VariationalProblem::objective(const Goals& goals, const Eigen::VectorXcd& x) const {
    Objective objective{*subject_->energy, factors_->free, rows_, spring_stiffness(), {}, factors_->sprung, {}};
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
            objective.conditions.push_back({turn, Complex(0, 1) * ahead, 0, true});
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

bool VariationalProblem::looks_natural(const Eigen::VectorXcd& x) const {
    const Distortion distortion = measure_distortion(subject_->mesh, point_positions(x));
    return distortion.flipped_triangles == 0 && distortion.max_stretch < natural_stretch;
}

bool VariationalProblem::scales_settled(const Goals& goals, const Eigen::VectorXcd& x) const {
    for (std::size_t h = 0; h < goals.holds.size(); ++h) {
        const HoldGoal& goal = goals.holds[h];
        if (!goal.scale || goal.angle_rad) continue;
        const double off = std::abs(row_value(binding_.holds[h].turn, x)) - *goal.scale;
        if (std::abs(off) > (guards_folds() ? settled_sprung_scale : settled_scale)) return false;
    }
    return true;
}

const HessianFactory& VariationalProblem::factory() const {
    std::call_once(factors_->factory_made, [&] {
        const VertexSprings springs{factors_->sprung, spring_stiffness()};
        factors_->factory =
            std::make_unique<const HessianFactory>(*subject_->energy, factors_->free, factors_->grounds, springs);
    });
    return *factors_->factory;
}

std::shared_ptr<ConstrainedMetric> VariationalProblem::metric(const Eigen::VectorXcd& x,
                                                              const Objective& objective) const {
    if (!constant_metric()) return exact_metric(x, objective);
    auto metric =
        std::make_shared<ConstrainedMetric>(factors_->constant, rest().size(), factors_->grounds, objective.penalty);
    choose(*metric, objective);
    return metric;
}

std::shared_ptr<ConstrainedMetric> VariationalProblem::exact_metric(const Eigen::VectorXcd& x,
                                                                    const Objective& objective) const {
    auto metric = std::make_shared<ConstrainedMetric>(factory().factorise(x), rest().size(), factors_->grounds,
                                                      objective.penalty);
    choose(*metric, objective);
    return metric;
}

std::shared_ptr<ConstrainedMetric> VariationalProblem::adopted(const ConstrainedMetric& metric,
                                                               const VariationalProblem& other,
                                                               const Objective& objective) const {
    std::vector<int> old_of_new;
    for (const ComplexRow& row : rows_) {
        const auto found = std::find(other.rows_.begin(), other.rows_.end(), row);
        old_of_new.push_back(found == other.rows_.end() ? -1 : static_cast<int>(found - other.rows_.begin()));
    }
    std::shared_ptr<ConstrainedMetric> own = metric.with_rows(old_of_new);
    choose(*own, objective);
    return own;
}

bool VariationalProblem::choose(ConstrainedMetric& metric, const Objective& objective) const {
    return metric.choose(rows_, objective.conditions, leaves_rigid_freedom(objective));
}

// Whether some component is held in less than two places and at no angle.
bool VariationalProblem::leaves_rigid_freedom(const Objective& objective) const {
    std::vector<int> holding = component_places_;
    for (const Condition& condition : objective.conditions) {
        if (!condition.fixes_angle) continue;
        const auto h = static_cast<std::size_t>(condition.row / 2);
        ++holding[static_cast<std::size_t>(binding_.holds[h].component)];
    }
    return std::any_of(holding.begin(), holding.end(), [](int count) { return count == 1; });
}

}  // namespace puppetwarp
