#include <puppetwarp/deform/polyharmonic.h>

#include <puppetwarp/base/errors.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace puppetwarp {

namespace {

using Complex = std::complex<double>;

// Handles whose targets are missed by more than this share of the subject's size contradict each other.
constexpr double contradiction = 1e-6;

ComplexRow times(const ComplexRow& row, double factor) {
    ComplexRow result = row;
    for (auto& entry : result) entry.second *= factor;
    return result;
}

}  // namespace

PolyharmonicDeformer::PolyharmonicDeformer(int order, const TriangleMesh& mesh, const Rig& rig)
    : order_(order),
      rest_(complex_positions(mesh.V)),
      size_(bounding_diagonal(mesh.V)),
      rig_(rig),
      mesh_(mesh),
      binding_(take_hold(mesh, rig, name())),
      component_(vertex_components(mesh)),
      L_(cotangent_stiffness(mesh, order == 1 ? triangle_stiffness(mesh, rig.stiffness) : Eigen::VectorXd())),
      M_(lumped_mass(mesh)),
      component_mass_(Eigen::VectorXd::Zero(component_.maxCoeff() + 1)),
      inverse_(L_, component_) {
    for (int v = 0; v < component_.size(); ++v) component_mass_(component_(v)) += M_(v);
    for (const Hold& hold : binding_.holds) held_.push_back(hold.component);
    for (const HeldVertex& held : binding_.vertices) held_.push_back(component_(held.vertex));
    std::sort(held_.begin(), held_.end());
    held_.erase(std::unique(held_.begin(), held_.end()), held_.end());
    prepare_rows();
}

std::string PolyharmonicDeformer::name() const {
    return method_name(order_ == 1 ? Method::harmonic : Method::biharmonic);
}

// Up to a constant on each component, which the saddle system finds. Right for loads that sum to 0 there; linear and
// symmetric for all.
Eigen::VectorXcd PolyharmonicDeformer::apply_inverse(const Eigen::VectorXcd& r) const {
    Eigen::VectorXcd z = inverse_ * r;
    for (int power = 1; power < order_; ++power) {
        Eigen::VectorXcd mean = Eigen::VectorXcd::Zero(component_mass_.size());
        for (int v = 0; v < z.size(); ++v) mean(component_(v)) += M_(v) * z(v);
        // A vertex of no triangle has no mass.
        for (int v = 0; v < z.size(); ++v) {
            if (M_(v) > 0) z(v) = M_(v) * (z(v) - mean(component_(v)) / component_mass_(component_(v)));
        }
        z = inverse_ * z;
    }
    return z;
}

// C^H times the multipliers.
Eigen::VectorXcd PolyharmonicDeformer::load(const std::vector<int>& rows, const Eigen::VectorXcd& multipliers) const {
    Eigen::VectorXcd r = Eigen::VectorXcd::Zero(rest_.size());
    for (std::size_t i = 0; i < rows.size(); ++i) {
        for (const auto& [vertex, coefficient] : rows_[static_cast<std::size_t>(rows[i])].entries) {
            r(vertex) += std::conj(coefficient) * multipliers(static_cast<Eigen::Index>(i));
        }
    }
    return r;
}

void PolyharmonicDeformer::prepare_rows() {
    const int holds = static_cast<int>(binding_.holds.size());
    for (int h = 0; h < holds; ++h) {
        const Hold& hold = binding_.holds[static_cast<std::size_t>(h)];
        rows_.push_back({h, false, false, hold.component, hold.mean});
    }
    for (const HeldVertex& held : binding_.vertices) {
        const int index = static_cast<int>(rows_.size()) - holds;
        rows_.push_back({index, true, false, component_(held.vertex), {{held.vertex, 1.0}}});
    }
    const std::size_t means = rows_.size();
    for (int h = 0; h < holds; ++h) {
        const Hold& hold = binding_.holds[static_cast<std::size_t>(h)];
        if (!hold.turn.empty()) rows_.push_back({h, false, true, hold.component, times(hold.turn, hold.radius_px)});
    }
    const auto size = static_cast<Eigen::Index>(rows_.size());
    response_.resize(size, size);
    for (Eigen::Index j = 0; j < size; ++j) {
        const Eigen::VectorXcd u = apply_inverse(load({static_cast<int>(j)}, Eigen::VectorXcd::Ones(1)));
        for (Eigen::Index i = 0; i < size; ++i)
            response_(i, j) = row_value(rows_[static_cast<std::size_t>(i)].entries, u);
    }

    // A row at the grounded vertex responds to nothing: it gets the mean size.
    const Eigen::VectorXd diagonal = response_.diagonal().real();
    const double typical = std::max(diagonal.mean(), 1e-300);
    scale_ = Eigen::VectorXd::Constant(size + static_cast<Eigen::Index>(held_.size()), std::sqrt(typical));
    for (Eigen::Index i = 0; i < size; ++i) scale_(i) = 1 / std::sqrt(std::max(diagonal(i), 1e-6 * typical));

    mean_rows_.resize(means);
    std::iota(mean_rows_.begin(), mean_rows_.end(), 0);
    mean_solver_ = saddle_solver(mean_rows_);
}

// [ response  ones ] over the rows in use and one constant for each held component,
// [ ones^H    0    ] scaled to similar size.
PolyharmonicDeformer::Solver PolyharmonicDeformer::saddle_solver(const std::vector<int>& rows) const {
    const auto m = static_cast<Eigen::Index>(rows.size());
    const auto c = static_cast<Eigen::Index>(held_.size());
    Eigen::MatrixXcd saddle = Eigen::MatrixXcd::Zero(m + c, m + c);
    for (Eigen::Index i = 0; i < m; ++i) {
        const int row = rows[static_cast<std::size_t>(i)];
        const Row& entry = rows_[static_cast<std::size_t>(row)];
        for (Eigen::Index j = 0; j < m; ++j) {
            const int column = rows[static_cast<std::size_t>(j)];
            saddle(i, j) = scale_(row) * response_(row, column) * scale_(column);
        }
        if (entry.turn) continue;
        const auto at = std::lower_bound(held_.begin(), held_.end(), entry.component) - held_.begin();
        const Eigen::Index constant = m + static_cast<Eigen::Index>(at);
        const double unit =
            scale_(row) * scale_(static_cast<Eigen::Index>(rows_.size()) + static_cast<Eigen::Index>(at));
        saddle(i, constant) = saddle(constant, i) = unit;
    }
    Solver solver;
    solver.setThreshold(1e-13);
    solver.compute(saddle);
    return solver;
}

// The displacement of least energy with C u = d.
Eigen::VectorXcd PolyharmonicDeformer::solve_rows(const Solver& solver, const std::vector<int>& rows,
                                                  const Eigen::VectorXcd& d) const {
    const auto m = static_cast<Eigen::Index>(rows.size());
    const auto c = static_cast<Eigen::Index>(held_.size());
    Eigen::VectorXcd b = Eigen::VectorXcd::Zero(m + c);
    Eigen::VectorXd row_scale(m);
    for (Eigen::Index i = 0; i < m; ++i) {
        row_scale(i) = scale_(rows[static_cast<std::size_t>(i)]);
        b(i) = row_scale(i) * d(i);
    }
    const Eigen::VectorXcd solution = solver.solve(b);
    const Eigen::VectorXcd multipliers = solution.head(m).cwiseProduct(row_scale);
    const Eigen::VectorXcd constants = solution.tail(c).cwiseProduct(scale_.tail(c));
    Eigen::VectorXcd u = apply_inverse(load(rows, multipliers));
    for (int v = 0; v < u.size(); ++v) {
        const auto at = std::lower_bound(held_.begin(), held_.end(), component_(v));
        if (at == held_.end() || *at != component_(v)) continue;
        u(v) += constants(static_cast<Eigen::Index>(at - held_.begin()));
    }
    return u;
}

double PolyharmonicDeformer::energy_of(const Eigen::VectorXcd& u) const {
    Eigen::VectorXcd y = L_ * u;
    if (order_ == 1) return u.dot(y).real();
    double energy = 0;
    for (int v = 0; v < y.size(); ++v) {
        if (M_(v) > 0) energy += std::norm(y(v)) / M_(v);
    }
    return energy;
}

Deformation PolyharmonicDeformer::deform(const Pose& pose, const Eigen::MatrixX2d*, Progress& progress) const {
    progress.step("deform", 0);
    const Targets targets = resolve(binding_, mesh_, rig_, pose, AffineUse::no, name());
    std::vector<int> rows;
    std::vector<Complex> wanted;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
        const auto [index, vertex, turn, component, entries] = rows_[i];
        if (vertex) {
            rows.push_back(static_cast<int>(i));
            wanted.push_back(targets.vertices(index) - rest_(entries.front().first));
            continue;
        }
        const Hold& hold = binding_.holds[static_cast<std::size_t>(index)];
        const HoldTarget& target = targets.holds[static_cast<std::size_t>(index)];
        if (target.scale && !target.rotate_rad) {
            throw InvalidInput("handle '" + rig_.handles[static_cast<std::size_t>(hold.handle)].id + "'",
                               "'" + name() + "' can set a scale only together with an angle", "give rotate_deg too");
        }
        if (turn && !target.rotate_rad) continue;
        rows.push_back(static_cast<int>(i));
        // At rest f_z is 1; the rows speak of displacements.
        wanted.push_back(turn ? hold.radius_px * (std::polar(target.scale.value_or(1), *target.rotate_rad) - 1.0)
                              : target.move);
    }
    const Eigen::VectorXcd d =
        Eigen::Map<const Eigen::VectorXcd>(wanted.data(), static_cast<Eigen::Index>(wanted.size()));
    const bool means_only = rows.size() == mean_rows_.size();
    const Solver own = means_only ? Solver() : saddle_solver(rows);
    const Solver& solver = means_only ? mean_solver_ : own;

    const auto missed = [&](const Eigen::VectorXcd& u) {
        Eigen::VectorXcd rest = d;
        for (std::size_t i = 0; i < rows.size(); ++i) {
            rest(static_cast<Eigen::Index>(i)) -= row_value(rows_[static_cast<std::size_t>(rows[i])].entries, u);
        }
        return rest;
    };
    Eigen::VectorXcd u = solve_rows(solver, rows, d);
    // What round-off left of the constraints is solved for once more.
    u += solve_rows(solver, rows, missed(u));

    Deformation result;
    result.max_handle_error_px = missed(u).cwiseAbs().maxCoeff();
    if (result.max_handle_error_px > contradiction * size_) {
        throw InvalidInput("pose '" + pose.name + "'",
                           "handles that are close together ask for what cannot be met together",
                           "move them apart, or remove one");
    }
    Eigen::VectorXcd x = rest_ + u;
    result.warnings = binding_.warnings;
    result.V = point_positions(x);
    result.energy = energy_of(x - rest_);
    result.energy_history = {result.energy};
    return result;
}

}  // namespace puppetwarp
