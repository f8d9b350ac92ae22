#include <puppetwarp/deform/held_quadratic.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/deform/mean_system.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

namespace puppetwarp {

namespace {

using Complex = std::complex<double>;

// Handles whose targets are missed by more than this share of the subject's size contradict each other.
constexpr double trace_share = 1e-9;
constexpr double contradiction = 1e-6;
// What is missed by less than this share is round-off.
constexpr double round_off = 1e-14;
constexpr int preparing_passes = 3;
constexpr Eigen::Index few_means = 32;

ComplexRow times(const ComplexRow& row, double factor) {
    ComplexRow result = row;
    for (auto& entry : result) entry.second *= factor;
    return result;
}

int farthest(const std::vector<int>& from, const Eigen::VectorXcd& rest, const std::vector<int>& vertices,
             const Complex& place) {
    int best = from.front();
    for (const int i : from) {
        const auto distance = [&](int k) { return std::abs(rest(vertices[static_cast<std::size_t>(k)]) - place); };
        if (distance(i) > distance(best)) best = i;
    }
    return best;
}

}  // namespace

QuadraticForm squared_norm(const QuadraticForm::Matrix& B, QuadraticForm::NullSpace null_space) {
    const QuadraticForm::Matrix adjoint = B.adjoint();
    QuadraticForm form;
    form.A = adjoint * B;
    form.A.makeCompressed();
    form.null_space = null_space;
    form.product = [adjoint, B](const Eigen::VectorXcd& x) -> Eigen::VectorXcd {
        const Eigen::VectorXcd y = B * x;
        return adjoint * y;
    };
    return form;
}

HeldQuadratic::HeldQuadratic(QuadraticForm form, const TriangleMesh& mesh, const Binding& binding, AffineUse affine)
    : form_(std::move(form)), rest_(complex_positions(mesh.V)), size_(bounding_diagonal(mesh.V)) {
    for (Eigen::Index k = 0; k < form_.A.nonZeros() && real_; ++k) real_ = form_.A.valuePtr()[k].imag() == 0;
    find_unknowns(binding);
    find_modes(vertex_components(mesh));
    prepare_rows(binding, affine);
    if (form_.null_space == QuadraticForm::NullSpace::similarities) keep_idle_modes();
    factorise();
    prepare_fields();
}

void HeldQuadratic::find_unknowns(const Binding& binding) {
    slot_.assign(static_cast<std::size_t>(rest_.size()), 0);
    for (std::size_t v = 0; v < slot_.size(); ++v) {
        if (binding.loose[v]) slot_[v] = -1;
    }
    for (const HeldVertex& held : binding.vertices) {
        slot_[static_cast<std::size_t>(held.vertex)] = -1;
        vertices_.push_back(held.vertex);
    }
    for (std::size_t v = 0; v < slot_.size(); ++v) {
        if (slot_[v] < 0) continue;
        slot_[v] = static_cast<int>(free_.size());
        free_.push_back(static_cast<int>(v));
    }
}

void HeldQuadratic::find_modes(const Eigen::VectorXi& component) {
    std::vector<std::vector<int>> free(static_cast<std::size_t>(component.maxCoeff() + 1)), held(free.size());
    for (std::size_t i = 0; i < free_.size(); ++i) {
        free[static_cast<std::size_t>(component(free_[i]))].push_back(static_cast<int>(i));
    }
    for (const int v : vertices_) held[static_cast<std::size_t>(component(v))].push_back(v);
    for (std::size_t c = 0; c < free.size(); ++c) {
        if (!free[c].empty()) add_modes(free[c], held[c]);
    }
}

// Motions of one component that cost nothing and leave its held vertices where they are, and unknowns that stop them.
void HeldQuadratic::add_modes(const std::vector<int>& free, const std::vector<int>& held) {
    const auto at = [&](int i) { return rest_(free_[static_cast<std::size_t>(i)]); };
    const auto count = static_cast<Eigen::Index>(free.size());
    const bool similarities = form_.null_space == QuadraticForm::NullSpace::similarities;
    if (!held.empty()) {
        const Complex centre = rest_(held.front());
        for (const int v : held) {
            if (std::abs(rest_(v) - centre) > one_vertex * size_) return;
        }
        if (!similarities) return;
        Eigen::VectorXcd arm(count);
        for (Eigen::Index i = 0; i < count; ++i) arm(i) = at(free[static_cast<std::size_t>(i)]) - centre;
        if (arm.norm() <= one_vertex * size_) return;
        grounds_.push_back(farthest(free, rest_, free_, centre));
        modes_.push_back({free, arm / arm.norm()});
        return;
    }
    Complex centre = 0;
    for (const int i : free) centre += at(i) / static_cast<double>(count);
    modes_.push_back({free, Eigen::VectorXcd::Constant(count, 1 / std::sqrt(static_cast<double>(count)))});
    grounds_.push_back(farthest(free, rest_, free_, centre));
    Eigen::VectorXcd arm(count);
    for (Eigen::Index i = 0; i < count; ++i) arm(i) = at(free[static_cast<std::size_t>(i)]) - centre;
    if (!similarities || arm.norm() <= one_vertex * size_) return;
    grounds_.push_back(farthest(free, rest_, free_, at(grounds_.back())));
    modes_.push_back({free, arm / arm.norm()});
}

// Leaves only modes that move no mean: means are stiff then, and hold the others.
void HeldQuadratic::keep_idle_modes() {
    std::vector<Mode> idle_modes;
    grounds_.clear();
    for (std::size_t first = 0; first < modes_.size();) {
        std::size_t end = first + 1;
        while (end < modes_.size() && modes_[end].free == modes_[first].free) ++end;
        const std::vector<int>& free = modes_[first].free;
        Eigen::MatrixXcd values(static_cast<Eigen::Index>(free.size()), static_cast<Eigen::Index>(end - first));
        Eigen::MatrixXcd means(static_cast<Eigen::Index>(means_.size()), values.cols());
        for (Eigen::Index i = 0; i < values.cols(); ++i) {
            values.col(i) = modes_[first + static_cast<std::size_t>(i)].value;
            Eigen::VectorXcd u = Eigen::VectorXcd::Zero(static_cast<Eigen::Index>(free_.size()));
            u(free) = values.col(i);
            means.col(i) = means_of(u);
        }
        const Eigen::MatrixXcd kept = values * null_space(means);
        for (Eigen::Index i = 0; i < kept.cols(); ++i) {
            Eigen::Index farthest_moved = 0;
            kept.col(i).cwiseAbs().maxCoeff(&farthest_moved);
            grounds_.push_back(free[static_cast<std::size_t>(farthest_moved)]);
            idle_modes.push_back({free, kept.col(i)});
        }
        first = end;
    }
    modes_ = std::move(idle_modes);
}

// mean_stiffness_ times |mean|^2; the weights of means are real.
void HeldQuadratic::add_stiffness(const ComplexRow& mean, int parts,
                                  std::vector<Eigen::Triplet<double>>& entries) const {
    for (const auto& [row, first] : mean) {
        for (const auto& [column, second] : mean) {
            const int i = slot_[static_cast<std::size_t>(row)], j = slot_[static_cast<std::size_t>(column)];
            if (j < 0 || i < j) continue;
            for (int part = 0; part < parts; ++part) {
                entries.emplace_back(parts * i + part, parts * j + part,
                                     mean_stiffness_ * first.real() * second.real());
            }
        }
    }
}

// A over the unknowns, with as much added at the grounds as makes it definite. For loads that push no mode its inverse
// then is one of A itself, however much is added. What nearly costs nothing, as affine maps where similarities are
// free, would make the answers to loads on different means too much alike to tell apart: there the means themselves get
// a stiffness, which changes nothing once they are met. A complex matrix is factored as the real one of (Re, Im) pairs.
void HeldQuadratic::factorise() {
    if (free_.empty()) return;
    const int parts = real_ ? 1 : 2;
    std::vector<Eigen::Triplet<double>> entries;
    entries.reserve(static_cast<std::size_t>(form_.A.nonZeros()) * (real_ ? 1 : 2));
    double trace = 0;
    for (std::size_t column = 0; column < free_.size(); ++column) {
        for (QuadraticForm::Matrix::InnerIterator it(form_.A, free_[column]); it; ++it) {
            const int i = slot_[static_cast<std::size_t>(it.row())];
            const auto j = static_cast<int>(column);
            if (i < j) continue;
            if (i == j) trace += it.value().real();
            entries.emplace_back(parts * i, parts * j, it.value().real());
            if (real_) continue;
            entries.emplace_back(2 * i + 1, 2 * j + 1, it.value().real());
            entries.emplace_back(2 * i + 1, 2 * j, it.value().imag());
            if (i > j) entries.emplace_back(2 * i, 2 * j + 1, -it.value().imag());
        }
    }
    const double typical = trace / static_cast<double>(free_.size());
    if (form_.null_space == QuadraticForm::NullSpace::similarities) {
        mean_stiffness_ = typical;
        for (const ComplexRow& mean : means_) add_stiffness(mean, parts, entries);
    }
    for (const int ground : grounds_) {
        for (int part = 0; part < parts; ++part) {
            entries.emplace_back(parts * ground + part, parts * ground + part, typical);
        }
    }
    const auto size = parts * static_cast<Eigen::Index>(free_.size());
    Eigen::SparseMatrix<double> lower(size, size);
    lower.setFromTriplets(entries.begin(), entries.end());
    factor_ = CholeskyPattern(lower).factorise(lower);
    if (!factor_) {
        throw InvalidInput("mesh", "its triangles are too thin or too different in size to compute with",
                           "use a mesh with better triangles");
    }
}

// A row without its free vertices where they have next to no share in it: what handles hold decides it then, and what
// is left of the free ones is round-off that nobody could move by.
ComplexRow HeldQuadratic::without_traces(const ComplexRow& row) const {
    double free = 0, all = 0;
    const auto is_free = [&](int vertex) { return slot_[static_cast<std::size_t>(vertex)] >= 0; };
    for (const auto& [vertex, coefficient] : row) {
        all += std::abs(coefficient);
        if (is_free(vertex)) free += std::abs(coefficient);
    }
    ComplexRow result = row;
    if (free < trace_share * all) std::erase_if(result, [&](const auto& entry) { return is_free(entry.first); });
    return result;
}

void HeldQuadratic::prepare_rows(const Binding& binding, AffineUse affine) {
    for (std::size_t h = 0; h < binding.holds.size(); ++h) {
        const Hold& hold = binding.holds[h];
        means_.push_back(without_traces(hold.mean));
        if (hold.turn.empty()) continue;
        rows_.push_back({static_cast<int>(h), false, hold.radius_px, times(without_traces(hold.turn), hold.radius_px)});
        if (affine == AffineUse::no) continue;
        rows_.push_back({static_cast<int>(h), true, hold.radius_px, times(without_traces(hold.shear), hold.radius_px)});
    }
}

Eigen::VectorXcd HeldQuadratic::load_of(const ComplexRow& row) const {
    Eigen::VectorXcd load = Eigen::VectorXcd::Zero(static_cast<Eigen::Index>(free_.size()));
    for (const auto& [vertex, coefficient] : row) {
        const int i = slot_[static_cast<std::size_t>(vertex)];
        if (i >= 0) load(i) += std::conj(coefficient);
    }
    return load;
}

// Of multipliers on the means.
Eigen::VectorXcd HeldQuadratic::load_of(const Eigen::VectorXcd& multipliers) const {
    Eigen::VectorXcd load = Eigen::VectorXcd::Zero(static_cast<Eigen::Index>(free_.size()));
    for (std::size_t h = 0; h < means_.size(); ++h) {
        for (const auto& [vertex, coefficient] : means_[h]) {
            const int i = slot_[static_cast<std::size_t>(vertex)];
            if (i >= 0) load(i) += std::conj(coefficient) * multipliers(static_cast<Eigen::Index>(h));
        }
    }
    return load;
}

Complex HeldQuadratic::free_value(const ComplexRow& row, const Eigen::VectorXcd& u) const {
    Complex sum = 0;
    for (const auto& [vertex, coefficient] : row) {
        const int i = slot_[static_cast<std::size_t>(vertex)];
        if (i >= 0) sum += coefficient * u(i);
    }
    return sum;
}

// The answer without any mode to a load without its push on modes.
Eigen::VectorXcd HeldQuadratic::inverse(Eigen::VectorXcd load) const {
    const auto take_modes = [&](Eigen::VectorXcd& u) {
        for (const Mode& mode : modes_) {
            const Complex share = mode.value.dot(u(mode.free));
            u(mode.free) -= share * mode.value;
        }
    };
    take_modes(load);
    if (real_) {
        factor_->solve_in_place(load);
    } else {
        Eigen::VectorXd parts =
            Eigen::Map<const Eigen::VectorXd>(reinterpret_cast<const double*>(load.data()), 2 * load.size());
        factor_->solve_in_place(parts);
        Eigen::Map<Eigen::VectorXd>(reinterpret_cast<double*>(load.data()), parts.size()) = parts;
    }
    take_modes(load);
    return load;
}

// Answers to loads on the means, and the modes.
Eigen::MatrixXcd HeldQuadratic::mean_answers() const {
    const auto m = static_cast<Eigen::Index>(means_.size());
    const auto k = static_cast<Eigen::Index>(modes_.size());
    Eigen::MatrixXcd fields = Eigen::MatrixXcd::Zero(static_cast<Eigen::Index>(free_.size()), m + k);
    for (Eigen::Index h = 0; h < m; ++h) fields.col(h) = inverse(load_of(means_[static_cast<std::size_t>(h)]));
    for (Eigen::Index i = 0; i < k; ++i) {
        const Mode& mode = modes_[static_cast<std::size_t>(i)];
        fields.col(m + i)(mode.free) = mode.value;
    }
    return fields;
}

Eigen::VectorXcd HeldQuadratic::means_of(const Eigen::VectorXcd& u) const {
    Eigen::VectorXcd values(static_cast<Eigen::Index>(means_.size()));
    for (std::size_t h = 0; h < means_.size(); ++h) values(static_cast<Eigen::Index>(h)) = free_value(means_[h], u);
    return values;
}

// What multipliers on means and shares of modes make: by a product with all fields while these are few.
Eigen::VectorXcd HeldQuadratic::answer(const Eigen::MatrixXcd& fields, const Eigen::VectorXcd& shares) const {
    const auto m = static_cast<Eigen::Index>(means_.size());
    if (m <= few_means) return fields.leftCols(shares.size()) * shares;
    return inverse(load_of(Eigen::VectorXcd(shares.head(m)))) +
           fields.middleCols(m, shares.size() - m) * shares.tail(shares.size() - m);
}

// The field of a load and given means, and the multipliers on the means that hold it. Passes take away what round-off
// left of the equations, so that errors grow with the condition of B, not of A = B^H B.
// \param fields  what loads on the means answer, then modes.   \param system  inverse of the MeanSystem of these.
HeldQuadratic::Field HeldQuadratic::field_of(const Eigen::VectorXcd& load, const Eigen::VectorXcd& means,
                                             const Eigen::MatrixXcd& fields, const Eigen::MatrixXcd& system) const {
    const Eigen::Index m = means.size(), modes = system.cols() - m;
    Eigen::VectorXcd x = Eigen::VectorXcd::Zero(rest_.size());
    Eigen::VectorXcd multipliers = Eigen::VectorXcd::Zero(m);
    for (int pass = 0; pass < preparing_passes; ++pass) {
        const Eigen::VectorXcd missing = load + load_of(multipliers) - form_.product(x)(free_);
        const Eigen::VectorXcd u = inverse(missing);
        Eigen::VectorXcd b(m + modes);
        b << means - means_of(x(free_)) - means_of(u), -(fields.middleCols(m, modes).adjoint() * missing);
        const Eigen::VectorXcd shares = system * b;
        const Eigen::VectorXcd change = u + answer(fields, shares);
        multipliers += shares.head(m) - mean_stiffness_ * means_of(change);
        add(change, x);
    }
    return {x(free_), multipliers};
}

void HeldQuadratic::prepare_fields() {
    if (free_.empty()) return;
    const auto m = static_cast<Eigen::Index>(means_.size());
    const auto t = static_cast<Eigen::Index>(rows_.size());
    const Eigen::MatrixXcd fields = mean_answers();
    // Modes that stiff means leave over move none of these.
    const Eigen::Index k = mean_stiffness_ > 0 ? 0 : fields.cols() - m;
    Eigen::MatrixXcd means(m, m + k);
    for (Eigen::Index i = 0; i < m + k; ++i) means.col(i) = means_of(fields.col(i));
    const Eigen::MatrixXcd system = MeanSystem(means).inverse();
    mean_fields_.resize(fields.rows(), m);
    mean_multipliers_.resize(m, m);
    const Eigen::VectorXcd nothing = Eigen::VectorXcd::Zero(fields.rows());
    for (Eigen::Index h = 0; h < m; ++h) {
        const Field field = field_of(nothing, Eigen::VectorXcd::Unit(m, h), fields, system);
        mean_fields_.col(h) = field.u;
        mean_multipliers_.col(h) = field.multipliers;
    }
    row_fields_.resize(fields.rows(), t);
    row_multipliers_.resize(m, t);
    for (Eigen::Index i = 0; i < t; ++i) {
        const Eigen::VectorXcd load = load_of(rows_[static_cast<std::size_t>(i)].entries);
        const Field field = field_of(load, Eigen::VectorXcd::Zero(m), fields, system);
        row_fields_.col(i) = field.u;
        row_multipliers_.col(i) = field.multipliers;
    }
    idle_fields_ = fields.rightCols(fields.cols() - m);
    if (mean_stiffness_ == 0) idle_fields_ *= null_space(means.rightCols(k));

    row_response_.resize(t, t);
    idle_response_.resize(t, idle_fields_.cols());
    for (Eigen::Index i = 0; i < t; ++i) {
        const ComplexRow& row = rows_[static_cast<std::size_t>(i)].entries;
        for (Eigen::Index j = 0; j < t; ++j) row_response_(i, j) = free_value(row, row_fields_.col(j));
        for (Eigen::Index j = 0; j < idle_fields_.cols(); ++j) {
            idle_response_(i, j) = free_value(row, idle_fields_.col(j));
        }
    }
}

HeldGoals HeldQuadratic::goals_of(const Targets& targets, const Eigen::VectorXcd& rest, bool free_scale) const {
    HeldGoals goals;
    goals.means.resize(static_cast<Eigen::Index>(means_.size()));
    for (std::size_t h = 0; h < means_.size(); ++h) {
        goals.means(static_cast<Eigen::Index>(h)) = row_value(means_[h], rest) + targets.holds[h].move;
    }
    goals.vertices = targets.vertices;
    for (std::size_t i = 0; i < rows_.size(); ++i) {
        const HoldTarget& target = targets.holds[static_cast<std::size_t>(rows_[i].hold)];
        const auto row = static_cast<int>(i);
        const double radius = rows_[i].radius_px;
        if (rows_[i].shear) {
            if (target.shear) goals.rows.push_back({row, RowGoal::Kind::value, radius * *target.shear});
        } else if (target.rotate_rad) {
            const bool free = free_scale && !target.scale;
            goals.rows.push_back({row, free ? RowGoal::Kind::direction : RowGoal::Kind::value,
                                  std::polar(radius * target.scale.value_or(1), *target.rotate_rad)});
        } else if (target.scale) {
            goals.rows.push_back({row, RowGoal::Kind::length, radius * *target.scale});
        }
    }
    return goals;
}

Eigen::VectorXcd HeldQuadratic::missing_means(const HeldGoals& goals, const Eigen::VectorXcd& x) const {
    Eigen::VectorXcd missing = goals.means;
    for (std::size_t h = 0; h < means_.size(); ++h) {
        missing(static_cast<Eigen::Index>(h)) -= row_value(means_[h], x);
    }
    return missing;
}

void HeldQuadratic::add(const Eigen::VectorXcd& u, Eigen::VectorXcd& x) const {
    for (std::size_t i = 0; i < free_.size(); ++i) x(free_[i]) += u(static_cast<Eigen::Index>(i));
}

// Brings the means and rows of x to their goals; returns the push of these constraints on the unknowns.
Eigen::VectorXcd HeldQuadratic::meet_goals(const HeldGoals& goals, Eigen::VectorXcd& x) const {
    Eigen::VectorXcd multipliers = Eigen::VectorXcd::Zero(static_cast<Eigen::Index>(means_.size()));
    // What round-off leaves of the means is met by another pass, where it is more than round-off of the positions.
    for (int pass = 0; pass < 2 && !means_.empty(); ++pass) {
        const Eigen::VectorXcd missing = missing_means(goals, x);
        if (missing.lpNorm<Eigen::Infinity>() <= round_off * size_) break;
        add(mean_fields_ * missing, x);
        multipliers += mean_multipliers_ * missing;
    }
    if (goals.rows.empty()) return load_of(multipliers);
    Eigen::VectorXcd values(static_cast<Eigen::Index>(rows_.size()));
    for (std::size_t i = 0; i < rows_.size(); ++i) {
        values(static_cast<Eigen::Index>(i)) = row_value(rows_[i].entries, x);
    }
    const RowSteps steps = meet(goals.rows, values, row_response_, idle_response_);
    add(row_fields_ * steps.multipliers + idle_fields_ * steps.modes, x);
    Eigen::VectorXcd push = load_of(multipliers + row_multipliers_ * steps.multipliers);
    for (std::size_t i = 0; i < rows_.size(); ++i) {
        if (const Complex share = steps.multipliers(static_cast<Eigen::Index>(i)); share != 0.0) {
            push += share * load_of(rows_[i].entries);
        }
    }
    return push;
}

void HeldQuadratic::step(const HeldGoals& goals, const Eigen::VectorXcd* load, Eigen::VectorXcd& x, int passes) const {
    const Eigen::VectorXcd from = x;
    for (std::size_t k = 0; k < vertices_.size(); ++k) {
        x(vertices_[k]) = goals.vertices(static_cast<Eigen::Index>(k));
    }
    if (free_.empty()) return;
    if (load == nullptr && vertices_.empty()) {
        meet_goals(goals, x);
        return;
    }
    Eigen::VectorXcd push = Eigen::VectorXcd::Zero(static_cast<Eigen::Index>(free_.size()));
    if (load != nullptr) push = (*load)(free_);
    for (int pass = 0; pass < passes; ++pass) {
        const Eigen::VectorXcd moved = x - from;
        const Eigen::VectorXcd change = inverse(push - form_.product(moved)(free_));
        add(change, x);
        push += meet_goals(goals, x) - load_of(Eigen::VectorXcd(mean_stiffness_ * means_of(change)));
    }
}

double HeldQuadratic::largest_error(const HeldGoals& goals, const Eigen::VectorXcd& x) const {
    double largest = 0;
    for (std::size_t k = 0; k < vertices_.size(); ++k) {
        largest = std::max(largest, std::abs(goals.vertices(static_cast<Eigen::Index>(k)) - x(vertices_[k])));
    }
    if (!means_.empty()) largest = std::max(largest, missing_means(goals, x).lpNorm<Eigen::Infinity>());
    for (const RowGoal& goal : goals.rows) {
        const Complex value = row_value(rows_[static_cast<std::size_t>(goal.row)].entries, x);
        largest = std::max(largest, distance_to(goal, value));
    }
    return largest;
}

double HeldQuadratic::require_met(const HeldGoals& goals, const Eigen::VectorXcd& x, const std::string& pose) const {
    const double error = largest_error(goals, x);
    if (!(error <= contradiction * size_)) {
        throw InvalidInput("pose '" + pose + "'", "handles that are close together ask for what cannot be met together",
                           "move them apart, or remove one");
    }
    return error;
}

}  // namespace puppetwarp
