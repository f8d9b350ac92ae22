#include <puppetwarp/deform/skinning_weights.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/weights/weight_problem.h>
#include <puppetwarp/weights/weight_text.h>

#include <algorithm>
#include <cmath>
#include <optional>

namespace puppetwarp {

namespace {

// A vertex is one column's alone when its weights miss 1 and 0 by no more than round-off.
constexpr double round_off = 1e-12;

void require_fit(const Weights& weights, const TriangleMesh& mesh, const Rig& rig) {
    const auto columns = static_cast<Eigen::Index>(weights.columns.size());
    const auto fits = [&](const Eigen::MatrixXd& W) { return W.rows() == mesh.V.rows() && W.cols() == columns; };
    if (weights.columns != weight_columns(rig) || !fits(weights.W) ||
        (weights.W_imaginary.size() > 0 && !fits(weights.W_imaginary))) {
        throw InvalidInput("weights", "they are not of this mesh and these handles", "compute them anew");
    }
    if (!weights.W.allFinite() || !weights.W_imaginary.allFinite()) {
        throw InvalidInput("weights", "not all of them are finite", "compute them anew");
    }
}

}  // namespace

SkinningWeights::SkinningWeights(const Weights& weights, const TriangleMesh& mesh, const Rig& rig)
    : columns(weights.columns), imaginary(weights.W_imaginary), warnings(weight_warnings(weights)) {
    require_fit(weights, mesh, rig);
    rows = weights.W.sparseView(0, 0);
    rows.makeCompressed();
    for (Eigen::Index v = 0; v < rows.rows(); ++v) {
        int others = 0;
        std::optional<std::size_t> owner;
        for (WeightRows::InnerIterator w(rows, v); w; ++w) {
            if (std::abs(w.value() - 1) <= round_off) {
                owner = static_cast<std::size_t>(w.col());
            } else if (std::abs(w.value()) > round_off) {
                ++others;
            }
        }
        if (owner && others == 0) held.push_back({v, *owner});
    }
}

void SkinningWeights::add_imaginary(const std::vector<ColumnMotion>& motions, Eigen::VectorXcd& x) const {
    if (imaginary.size() == 0) return;
    Eigen::VectorXcd moves(imaginary.cols());
    for (Eigen::Index j = 0; j < moves.size(); ++j) {
        const ColumnMotion& motion = motions[static_cast<std::size_t>(j)];
        moves(j) = motion.map(motion.centre) - motion.centre;
    }
    x.real() -= imaginary * moves.imag();
    x.imag() += imaginary * moves.real();
}

double SkinningWeights::largest_error(const std::vector<ColumnMotion>& motions, const Eigen::VectorXcd& z,
                                      const Eigen::VectorXcd& x) const {
    double largest = 0;
    for (const Held& each : held) {
        largest = std::max(largest, std::abs(motions[each.column].map(z(each.vertex)) - x(each.vertex)));
    }
    return largest;
}

}  // namespace puppetwarp
