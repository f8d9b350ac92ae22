#pragma once

#include <puppetwarp/rig/rig.h>
#include <puppetwarp/weights/weights.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <random>

// Cages that tests make for themselves.
namespace puppetwarp::tests {

using Complex = std::complex<double>;

inline Complex complex(const Point& p) {
    return {p.x(), p.y()};
}

//! A star-shaped polygon about `centre`, of positive area, its radii random between two.
inline Polyline star(const Point& centre, int corners, double inner, double outer, std::uint32_t seed) {
    std::mt19937 random(seed);
    Polyline cage;
    for (int k = 0; k < corners; ++k) {
        const double share = static_cast<double>(random()) / 4294967296.0;
        const double angle = 2 * std::numbers::pi * k / corners, radius = inner + share * (outer - inner);
        cage.push_back(centre + radius * Point(std::cos(angle), std::sin(angle)));
    }
    return cage;
}

inline Polyline reversed(Polyline cage) {
    std::reverse(cage.begin(), cage.end());
    return cage;
}

inline Handle cage_handle(const std::string& id, const Polyline& points) {
    return {id, CageHandle{points}};
}

//! Where the weights of one cage, alone in its rig, take the vertices.
inline Eigen::MatrixX2d moved_by(const Weights& weights, const Polyline& targets) {
    Eigen::MatrixX2d V(weights.W.rows(), 2);
    for (Eigen::Index v = 0; v < V.rows(); ++v) {
        Complex z = 0;
        for (Eigen::Index j = 0; j < weights.W.cols(); ++j) {
            const double imaginary = weights.W_imaginary.size() > 0 ? weights.W_imaginary(v, j) : 0;
            z += Complex(weights.W(v, j), imaginary) * complex(targets[static_cast<std::size_t>(j)]);
        }
        V.row(v) << z.real(), z.imag();
    }
    return V;
}

}  // namespace puppetwarp::tests
