#include <puppetwarp/deform/held_field.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace puppetwarp {

namespace {

using Complex = std::complex<double>;

// Beyond this many responses a pose's own solve is no slower than their sum.
constexpr std::size_t most_responses = 64;

}  // namespace

HeldField::HeldField(std::shared_ptr<const FieldInverse> inverse, const Eigen::VectorXcd& rest, HeldVertices held)
    : inverse_(std::move(inverse)), held_(std::move(held)), middle_(rest.mean()) {
    size_ = std::max((rest.array() - middle_).abs().maxCoeff(), 1e-300);
    std::vector<int> first_of(held_.handles.size(), -1);
    std::vector<int> column(held_.vertices.size(), -1);
    std::size_t columns = 0;
    for (std::size_t i = 0; i < column.size(); ++i) {
        const auto h = static_cast<std::size_t>(held_.vertices[i].handle);
        if (held_.still[h]) continue;
        if (!held_.region[h] || first_of[h] < 0) {
            first_of[h] = static_cast<int>(columns);
            bases_.push_back({held_.vertices[i].handle, held_.region[h] ? -1 : static_cast<int>(i)});
            columns += held_.region[h] ? 3 : 1;
        }
        column[i] = first_of[h];
    }
    if (columns > most_responses) {
        bases_.clear();
        return;
    }
    Eigen::MatrixXd values = Eigen::MatrixXd::Zero(rest.size(), static_cast<Eigen::Index>(columns));
    for (std::size_t i = 0; i < column.size(); ++i) {
        const int v = held_.vertices[i].vertex;
        if (column[i] < 0) continue;
        values(v, column[i]) = 1;
        if (!held_.region[static_cast<std::size_t>(held_.vertices[i].handle)]) continue;
        values(v, column[i] + 1) = (rest(v).real() - middle_.real()) / size_;
        values(v, column[i] + 2) = (rest(v).imag() - middle_.imag()) / size_;
    }
    responses_ = columns == 0 ? values : inverse_->extend(values);
}

Eigen::VectorXcd HeldField::coefficients(const Eigen::VectorXcd& values, const std::vector<AffineMap>& maps,
                                         Complex offset) const {
    Eigen::VectorXcd result(responses_.cols());
    Eigen::Index column = 0;
    for (const Basis& basis : bases_) {
        if (basis.vertex >= 0) {
            result(column++) = values(basis.vertex) - offset;
            continue;
        }
        const AffineMap& map = maps[static_cast<std::size_t>(basis.handle)];
        result(column++) = map(middle_) - middle_ - offset;
        result(column++) = size_ * (map.alpha - 1.0 + map.beta);
        result(column++) = size_ * Complex(0, 1) * (map.alpha - 1.0 - map.beta);
    }
    return result;
}

Eigen::VectorXcd HeldField::operator()(const Eigen::VectorXcd& values, const std::vector<AffineMap>& maps,
                                       Complex offset) const {
    const Eigen::Index n = inverse_->vertices();
    Eigen::MatrixXd field = Eigen::MatrixXd::Zero(n, 2);
    if (!bases_.empty()) {
        const Eigen::VectorXcd of = coefficients(values, maps, offset);
        Eigen::MatrixXd parts(of.size(), 2);
        parts << of.real(), of.imag();
        field = responses_ * parts;
    } else if (!held_.vertices.empty()) {
        for (std::size_t i = 0; i < held_.vertices.size(); ++i) {
            if (held_.still[static_cast<std::size_t>(held_.vertices[i].handle)]) continue;
            const Complex value = values(static_cast<Eigen::Index>(i)) - offset;
            field.row(held_.vertices[i].vertex) << value.real(), value.imag();
        }
        if (!field.isZero(0)) field = inverse_->extend(field);
    }
    Eigen::VectorXcd u(n);
    u.real() = field.col(0);
    u.imag() = field.col(1);
    return u;
}

}  // namespace puppetwarp
