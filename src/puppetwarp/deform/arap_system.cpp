#include <puppetwarp/deform/arap_system.h>

#include <puppetwarp/base/errors.h>

#include <algorithm>

namespace puppetwarp {

namespace {

using Complex = std::complex<double>;

// Against the null space of rotations that a single pin leaves: far below what any deformation costs, far above
// round-off.
constexpr double regularisation = 1e-7;
// Constraints in the factor, against the mean stiffness of a vertex. What it leaves unmet is projected away.
constexpr double penalty_factor = 1e4;

}  // namespace

std::vector<ArapHold> arap_holds(const Binding& binding) {
    std::vector<ArapHold> holds;
    holds.reserve(binding.holds.size() + binding.vertices.size());
    for (const Hold& hold : binding.holds) holds.push_back({hold.mean, hold.turn, hold.radius_px, false});
    for (const HeldVertex& held : binding.vertices) holds.push_back({{{held.vertex, 1.0}}, {}, 0, true});
    return holds;
}

ArapSystem::ArapSystem(const ArapCells& cells, const std::vector<ArapHold>& holds, const std::vector<bool>& loose)
    : cells_(cells), slot_(loose.size(), 0) {
    for (std::size_t v = 0; v < loose.size(); ++v) {
        if (loose[v]) slot_[v] = -1;
    }
    for (const ArapHold& hold : holds) {
        if (hold.hard) slot_[static_cast<std::size_t>(hold.mean.front().first)] = -1;
    }
    for (std::size_t v = 0; v < slot_.size(); ++v) {
        if (slot_[v] < 0) continue;
        slot_[v] = static_cast<int>(free_.size());
        free_.push_back(static_cast<int>(v));
    }
    if (free_.empty()) return;
    build_pattern(holds);
    build_cell_map();
    pattern_.emplace(lower_);
}

void ArapSystem::build_pattern(const std::vector<ArapHold>& holds) {
    std::vector<Eigen::Triplet<double>> entries;
    const auto couple = [&](const std::vector<int>& vertices) {
        for (const int a : vertices) {
            for (const int b : vertices) {
                const int i = slot_[static_cast<std::size_t>(a)];
                const int j = slot_[static_cast<std::size_t>(b)];
                if (i < j || j < 0) continue;
                for (int k = 0; k < 4; ++k) {
                    const int row = 2 * i + k / 2;
                    const int column = 2 * j + k % 2;
                    if (row >= column) entries.emplace_back(row, column, 0.0);
                }
            }
        }
    };
    for (int c = 0; c < cells_.count(); ++c) couple({cells_.vertices_begin(c), cells_.vertices_end(c)});
    for (const ArapHold& hold : holds) {
        std::vector<int> vertices;
        for (const auto& entry : hold.mean) vertices.push_back(entry.first);
        for (const auto& entry : hold.turn) vertices.push_back(entry.first);
        std::sort(vertices.begin(), vertices.end());
        vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
        couple(vertices);
    }
    double sum = 0;
    for (int column = 0; column < cells_.K().cols(); ++column) {
        for (SparseMatrix::InnerIterator it(cells_.K(), column); it; ++it) {
            const int i = slot_[static_cast<std::size_t>(it.row())];
            const int j = slot_[static_cast<std::size_t>(column)];
            if (i < j || j < 0) continue;
            const double value = 2 * (1 + regularisation) * it.value();
            entries.emplace_back(2 * i, 2 * j, value);
            entries.emplace_back(2 * i + 1, 2 * j + 1, value);
            if (i == j) sum += value;
        }
    }
    lower_.resize(unknowns(), unknowns());
    lower_.setFromTriplets(entries.begin(), entries.end());
    penalty_ = penalty_factor * sum / static_cast<double>(free_.size());
}

int ArapSystem::find(int row, int column) const {
    if (row < column) std::swap(row, column);
    const int* begin = lower_.innerIndexPtr() + lower_.outerIndexPtr()[column];
    const int* end = lower_.innerIndexPtr() + lower_.outerIndexPtr()[column + 1];
    return static_cast<int>(std::lower_bound(begin, end, row) - lower_.innerIndexPtr());
}

void ArapSystem::build_cell_map() {
    for (int c = 0; c < cells_.count(); ++c) {
        std::vector<int> unknown;
        for (const int* v = cells_.vertices_begin(c); v != cells_.vertices_end(c); ++v) {
            const int i = slot_[static_cast<std::size_t>(*v)];
            unknown.push_back(i < 0 ? -1 : 2 * i);
            unknown.push_back(i < 0 ? -1 : 2 * i + 1);
        }
        for (std::size_t a = 0; a < unknown.size(); ++a) {
            for (std::size_t b = 0; b <= a; ++b) {
                cell_map_.push_back(unknown[a] < 0 || unknown[b] < 0 ? -1 : find(unknown[a], unknown[b]));
            }
        }
    }
}

Eigen::VectorXd ArapSystem::restricted(const Eigen::VectorXcd& x) const {
    Eigen::VectorXd y(unknowns());
    for (std::size_t i = 0; i < free_.size(); ++i) {
        y(2 * static_cast<Eigen::Index>(i)) = x(free_[i]).real();
        y(2 * static_cast<Eigen::Index>(i) + 1) = x(free_[i]).imag();
    }
    return y;
}

void ArapSystem::add(double factor, const Eigen::VectorXd& step, Eigen::VectorXcd& x) const {
    for (std::size_t i = 0; i < free_.size(); ++i) {
        const auto k = 2 * static_cast<Eigen::Index>(i);
        x(free_[i]) += factor * Complex(step(k), step(k + 1));
    }
}

std::vector<std::pair<int, double>> ArapSystem::real_row(const ComplexRow& row, Complex direction,
                                                         const Eigen::VectorXcd& x, double& fixed) const {
    std::vector<std::pair<int, double>> result;
    fixed = 0;
    for (const auto& [vertex, coefficient] : row) {
        // Re(c x) = Re c Re x - Im c Im x
        const Complex c = std::conj(direction) * coefficient;
        const int i = slot_[static_cast<std::size_t>(vertex)];
        if (i < 0) {
            fixed += (c * x(vertex)).real();
            continue;
        }
        if (c.real() != 0) result.emplace_back(2 * i, c.real());
        if (c.imag() != 0) result.emplace_back(2 * i + 1, -c.imag());
    }
    return result;
}

void ArapSystem::fill(Eigen::SparseMatrix<double>& H, const Eigen::VectorXcd& x, const ConstraintSpace& constraints,
                      Hessian kind) const {
    double* values = H.valuePtr();
    std::copy(lower_.valuePtr(), lower_.valuePtr() + lower_.nonZeros(), values);
    for (int r = 0; r < constraints.C().rows(); ++r) {
        for (ConstraintSpace::Rows::InnerIterator a(constraints.C(), r); a; ++a) {
            for (ConstraintSpace::Rows::InnerIterator b(constraints.C(), r); b && b.col() <= a.col(); ++b) {
                values[find(static_cast<int>(a.col()), static_cast<int>(b.col()))] += penalty_ * a.value() * b.value();
            }
        }
    }
    if (kind == Hessian::rotations_held) return;
    std::vector<Complex> room;
    const int* place = cell_map_.data();
    for (int c = 0; c < cells_.count(); ++c) {
        const ArapCells::Twist twist = cells_.twist(c, x, kind == Hessian::clamped, room);
        const auto* t = reinterpret_cast<const double*>(twist.t);
        const auto size = 2 * static_cast<int>(room.size());
        for (int a = 0; a < size; ++a) {
            const double factor = twist.weight * t[a];
            for (int b = 0; b <= a; ++b, ++place) {
                if (*place >= 0) values[*place] -= factor * t[b];
            }
        }
    }
}

ArapSystem::Factor ArapSystem::factorise(const Eigen::VectorXcd& x, const ConstraintSpace& constraints,
                                         bool try_exact) const {
    Eigen::SparseMatrix<double> H = lower_;
    for (const Hessian kind : {Hessian::exact, Hessian::clamped, Hessian::rotations_held}) {
        if (kind == Hessian::exact && !try_exact) continue;
        fill(H, x, constraints, kind);
        if (auto factor = pattern_->factorise(H)) return {std::move(*factor), kind};
    }
    throw InvalidInput("mesh", "its triangles are too thin or too different in size to compute with",
                       "use a mesh with better triangles");
}

}  // namespace puppetwarp
