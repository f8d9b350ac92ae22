#include <puppetwarp/weights/cauchy.h>

#include <puppetwarp/mesh/outline.h>
#include <puppetwarp/weights/cage_polygon.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

namespace puppetwarp {

namespace {

using Complex = std::complex<double>;
using std::numbers::pi;

Complex complex(const Point& p) {
    return {p.x(), p.y()};
}

// Coordinates with respect to one cage of positive area. Edge k runs from corner k to corner k + 1.
class Evaluator {
public:
    explicit Evaluator(const Polyline& cage)
        : cage_(cage), n_(cage.size()), on_cage_(on_cage_share * diagonal(cage)), B_(n_), log_(n_), L_(n_) {
        for (const Point& corner : cage) v_.push_back(complex(corner));
        for (std::size_t k = 0; k < n_; ++k) edge_.push_back(v_[next(k)] - v_[k]);
    }

    // \param row  #corners. \return whether the place is outside.
    bool evaluate(const Point& p, std::vector<Complex>& row) {
        const CageFoot foot = nearest_foot(cage_, p);
        const Complex z = complex(p);
        if (foot.distance <= on_cage_) {
            limit_at(foot, row);
            return false;
        }
        if (look_from(z) > pi) {
            sum_up(row);
            return false;
        }
        limit_at(foot, row);
        follow_edge(foot, z, row);
        return true;
    }

private:
    std::size_t next(std::size_t k) const { return k + 1 < n_ ? k + 1 : 0; }
    std::size_t before(std::size_t k) const { return k > 0 ? k - 1 : n_ - 1; }
    Complex place(const CageFoot& foot) const { return v_[foot.edge] + foot.along * edge_[foot.edge]; }

    // Sets B and L = log(B_{k+1} / B_k) for a place off the cage. \return the sum of the angles: 2 pi inside, else 0.
    double look_from(const Complex& z) {
        double turn = 0;
        for (std::size_t k = 0; k < n_; ++k) {
            B_[k] = v_[k] - z;
            log_[k] = 0.5 * std::log(std::norm(B_[k]));
        }
        for (std::size_t k = 0; k < n_; ++k) {
            L_[k] = {log_[next(k)] - log_[k], std::arg(B_[next(k)] * std::conj(B_[k]))};
            turn += L_[k].imag();
        }
        return turn;
    }

    void sum_up(std::vector<Complex>& row) const {
        const Complex scale(0, -0.5 / pi);
        for (std::size_t j = 0; j < n_; ++j) {
            const std::size_t last = before(j);
            row[j] = scale * (B_[next(j)] / edge_[j] * L_[j] - B_[last] / edge_[last] * L_[last]);
        }
    }

    // The limit from inside at a place on the cage.
    void limit_at(const CageFoot& foot, std::vector<Complex>& row) {
        const Complex z = place(foot);
        for (const std::size_t corner : {foot.edge, next(foot.edge)}) {
            if (std::abs(v_[corner] - z) > on_cage_) continue;
            limit_at_corner(corner, row);
            return;
        }
        // Seen from the edge it spans half a turn, but for round-off in z, which the others see too.
        const double others = look_from(z) - L_[foot.edge].imag();
        L_[foot.edge].imag(2 * pi - others);
        sum_up(row);
    }

    // B_j = 0 there: of the two logarithms that grow beyond bounds, the coordinate of the corner holds the sum, in
    // which the growing parts cancel, and others hold them times B_j.
    void limit_at_corner(std::size_t corner, std::vector<Complex>& row) {
        look_from(v_[corner]);
        const std::size_t last = before(corner);
        L_[corner] = L_[last] = 0;
        double seen = 0;  // the angle under which the other edges are seen: the interior angle
        for (const Complex& L : L_) seen += L.imag();
        sum_up(row);
        const double stretch = std::log(std::abs(edge_[corner]) / std::abs(edge_[last]));
        row[corner] += Complex(0, -0.5 / pi) * Complex(stretch, 2 * pi - seen);
    }

    // Adds what lies between the cage and a place outside.
    void follow_edge(const CageFoot& foot, const Complex& z, std::vector<Complex>& row) const {
        const Complex away = z - place(foot);
        const auto add = [&](std::size_t edge, double share) {
            const Complex part = share * away / edge_[edge];
            row[next(edge)] += part;
            row[edge] -= part;
        };
        if (foot.along > 0 && foot.along < 1) {
            add(foot.edge, 1);
            return;
        }
        const std::size_t corner = foot.along > 0 ? next(foot.edge) : foot.edge, last = before(corner);
        // The place is seen from a convex corner between the normals of its two edges.
        const double fan = std::arg(edge_[corner] / edge_[last]);
        const double from_last = std::arg(away / (Complex(0, -1) * edge_[last]));
        const double share = fan > 0 ? std::clamp(from_last / fan, 0.0, 1.0) : 0.5;
        add(last, 1 - share);
        add(corner, share);
    }

    const Polyline& cage_;
    std::size_t n_;
    double on_cage_;
    std::vector<Complex> v_, edge_;
    std::vector<Complex> B_;
    std::vector<double> log_;  // of |B|
    std::vector<Complex> L_;   // of each edge
};

}  // namespace

CauchyCoordinates cauchy_coordinates(const Eigen::MatrixX2d& P, const Polyline& cage) {
    Polyline ordered = cage;
    const bool reversed = signed_area(cage) < 0;
    if (reversed) std::reverse(ordered.begin(), ordered.end());
    const auto n = static_cast<Eigen::Index>(cage.size());
    CauchyCoordinates found{Eigen::MatrixXcd(P.rows(), n), 0};
    Evaluator evaluator(ordered);
    std::vector<Complex> row(cage.size());
    for (Eigen::Index i = 0; i < P.rows(); ++i) {
        if (evaluator.evaluate(P.row(i).transpose(), row)) ++found.outside;
        for (Eigen::Index j = 0; j < n; ++j) found.C(i, reversed ? n - 1 - j : j) = row[static_cast<std::size_t>(j)];
    }
    return found;
}

}  // namespace puppetwarp
