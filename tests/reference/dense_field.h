#pragma once

#include <puppetwarp/mesh/triangle_mesh.h>

#include <complex>
#include <utility>
#include <vector>

// Displacement fields of least k-harmonic or thin-shell energy by one dense system in extended precision, with nothing
// of the library but the mesh: for tests.
namespace puppetwarp::reference {

//! sum over vertices of coefficient * displacement = value.
struct DenseConstraint {
    std::vector<std::pair<int, std::complex<double>>> row;
    std::complex<double> value;
};

//! weight * u^H L (M^-1 L)^(order - 1) u + first_order * u^H K u, with K of the triangles' `stiffness` (#F, or empty).
struct DenseEnergy {
    int order = 1;
    double weight = 1;
    double first_order = 0;
    Eigen::VectorXd stiffness;
};

//! The minimiser within the constraints, which must be independent and hold every component. #V
Eigen::VectorXcd dense_field(const TriangleMesh& mesh, const DenseEnergy& energy,
                             const std::vector<DenseConstraint>& constraints);

}  // namespace puppetwarp::reference
