#include <puppetwarp/deform/mixed_inverse.h>

#include <puppetwarp/base/errors.h>

#include <cmath>

namespace puppetwarp {

namespace {

std::vector<bool> in_whole_component(const Eigen::VectorXi& component, const std::vector<bool>& held) {
    std::vector<bool> whole(held.size(), true), result(held.size());
    for (std::size_t v = 0; v < held.size(); ++v) {
        if (held[v]) whole[static_cast<std::size_t>(component(static_cast<Eigen::Index>(v)))] = false;
    }
    for (std::size_t v = 0; v < held.size(); ++v) {
        result[v] = whole[static_cast<std::size_t>(component(static_cast<Eigen::Index>(v)))];
    }
    return result;
}

// A vertex of no triangle has no entry; its block needs a place.
SparseMatrix with_diagonal(const SparseMatrix& A) {
    SparseMatrix zero(A.rows(), A.cols());
    zero.setIdentity();
    return A + 0.0 * zero;
}

}  // namespace

MixedInverse::MixedInverse(const FieldEnergy& energy, const Eigen::VectorXi& component, const std::vector<bool>& held)
    : n_(energy.L.rows()),
      order_(energy.order),
      L_(with_diagonal(energy.L)),
      M_(energy.M),
      moving_(Eigen::VectorXd::Ones(n_)),
      whole_(in_whole_component(component, held)),
      means_(component, energy.M) {
    const double s = M_.mean();
    for (Eigen::Index v = 0; v < n_; ++v) M_(v) = M_(v) > 0 ? M_(v) / s : 1;
    load_scale_ = std::pow(s, order_ - 1) / energy.weight;
    if (energy.first_order > 0) {
        first_order_ = energy.first_order * load_scale_;
        K_ = energy.K.size() > 0 ? energy.K : energy.L;
    }
    int components = 0;
    for (Eigen::Index v = 0; v < n_; ++v) {
        // Where nothing is held, the constant is pinned at the first vertex.
        const bool first = component(v) == components;
        if (first) ++components;
        const auto i = static_cast<std::size_t>(v);
        if (held[i] || (first && whole_[i])) moving_(v) = 0;
    }
    factor_ = BlockLdlt::factorise(block_matrix());
    if (!factor_) {
        throw InvalidInput("mesh", "its triangles are too thin or too different in size to compute with",
                           "use a mesh with better triangles");
    }
}

// Block (v, w): L_vw where the levels' numbers sum to order - 1, -M_vw where they sum to order, and K_vw at (0, 0).
BlockMatrix MixedInverse::block_matrix() const {
    BlockMatrix A;
    A.size = order_;
    A.pattern = L_.triangularView<Eigen::Lower>();
    const auto size = static_cast<std::size_t>(order_);
    const std::size_t stride = size * size;
    A.blocks.assign(static_cast<std::size_t>(A.pattern.nonZeros()) * stride, 0.0);
    double* block = A.blocks.data();
    for (int column = 0; column < n_; ++column) {
        for (SparseMatrix::InnerIterator it(A.pattern, column); it; ++it, block += stride) {
            const bool diagonal = it.row() == column;
            const double row_moves = moving_(it.row()), column_moves = moving_(column);
            for (int i = 0; i < order_; ++i) {
                for (int j = 0; j < order_; ++j) {
                    double value = 0;
                    if (i + j == order_ - 1) value = it.value();
                    if (i + j == order_ && diagonal) value = -M_(column);
                    if (i + j == 0 && first_order_ > 0) value += first_order_ * K_.coeff(it.row(), column);
                    if (i == 0) value *= row_moves;
                    if (j == 0) value *= column_moves;
                    block[i + j * order_] = value;
                }
            }
            if (diagonal && column_moves == 0) block[0] = 1;
        }
    }
    return A;
}

// Component j of each block row. #V x #fields
Eigen::MatrixXd MixedInverse::level(const Eigen::MatrixXd& w, int j) const {
    return w(Eigen::seqN(j, n_, order_), Eigen::all);
}

Eigen::MatrixXd MixedInverse::system_times(const Eigen::MatrixXd& w) const {
    Eigen::MatrixXd result(w.rows(), w.cols());
    const Eigen::MatrixXd u = moving_.asDiagonal() * level(w, 0);
    for (int i = 0; i < order_; ++i) {
        const int j = order_ - 1 - i;
        Eigen::MatrixXd row = L_ * (j == 0 ? u : level(w, j));
        if (i > 0) row -= M_.asDiagonal() * level(w, order_ - i);
        if (i == 0) {
            if (first_order_ > 0) row += first_order_ * (K_ * u);
            row = moving_.asDiagonal() * row;
            row += (1 - moving_.array()).matrix().asDiagonal() * level(w, 0);
        }
        result(Eigen::seqN(i, n_, order_), Eigen::all) = row;
    }
    return result;
}

Eigen::MatrixXd MixedInverse::solve(const Eigen::MatrixXd& right_hand_side) const {
    Eigen::MatrixXd w = factor_->solve(right_hand_side);
    // Up to order 2 there is nothing to gain. At order 4 on fine meshes the error may be as large as 1e-7 at first; a
    // step squares it.
    if (order_ > 2) w += factor_->solve(right_hand_side - system_times(w));
    return w;
}

Eigen::MatrixXd MixedInverse::respond(const Eigen::MatrixXd& loads) const {
    // On components with held vertices the means stay; on the others the loads lose what they have no answer to.
    Eigen::MatrixXd spread = loads;
    means_.remove_from_loads(spread);
    Eigen::MatrixXd b = Eigen::MatrixXd::Zero(n_ * order_, loads.cols());
    for (Eigen::Index v = 0; v < n_; ++v) {
        const Eigen::MatrixXd& r = whole_[static_cast<std::size_t>(v)] ? spread : loads;
        b.row(v * order_) = load_scale_ * moving_(v) * r.row(v);
    }
    Eigen::MatrixXd u = level(solve(b), 0);
    Eigen::MatrixXd centred = u;
    means_.remove(centred);
    for (Eigen::Index v = 0; v < n_; ++v) {
        if (whole_[static_cast<std::size_t>(v)]) u.row(v) = centred.row(v);
    }
    return u;
}

Eigen::MatrixXd MixedInverse::extend(const Eigen::MatrixXd& values) const {
    Eigen::MatrixXd b = Eigen::MatrixXd::Zero(n_ * order_, values.cols());
    Eigen::MatrixXd top = Eigen::MatrixXd::Zero(n_, values.cols());
    const Eigen::MatrixXd Lh = L_ * values;
    if (order_ == 1) {
        top -= Lh;
    } else {
        b(Eigen::seqN(order_ - 1, n_, order_), Eigen::all) = -Lh;
    }
    if (first_order_ > 0) top -= first_order_ * (K_ * values);
    b(Eigen::seqN(0, n_, order_), Eigen::all) = moving_.asDiagonal() * top;
    return level(solve(b), 0) + values;
}

}  // namespace puppetwarp
