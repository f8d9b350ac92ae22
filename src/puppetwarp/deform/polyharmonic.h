#pragma once
// Private header.

#include <puppetwarp/deform/deformer.h>
#include <puppetwarp/mesh/operators.h>
#include <puppetwarp/rig/binding.h>
#include <puppetwarp/solve/grounded_inverse.h>

#include <Eigen/QR>

namespace puppetwarp {

//! `harmonic` (order 1) and `biharmonic` (order 2): the displacement u of least energy u^H L (M^-1 L)^(order - 1) u
//! that meets the handles, with every row of L.   Botsch & Kobbelt 2004, Jacobson et al. 2010.
//! The powers of L are never multiplied out: each application of the inverse is `order` solves with L, so that
//! round-off grows with the condition of L, not of its power. The handles are Lagrange multipliers; a point's
//! fixed angle, with scale 1 unless one is given, is one more.
//! Stiffness enters `harmonic` alone: the other energy is of second order.
class PolyharmonicDeformer : public Deformer {
public:
    PolyharmonicDeformer(int order, const TriangleMesh& mesh, const Rig& rig);
    Deformation deform(const Pose& pose, const Eigen::MatrixX2d* start, Progress& progress) const override;

private:
    using Solver = Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXcd>;

    // A constraint row: the mean of a hold or a held vertex, or a hold's turn (scaled by its radius to a length).
    struct Row {
        int index;  // of the hold, or of the vertex in the binding
        bool vertex;
        bool turn;
        int component;
        ComplexRow entries;
    };

    std::string name() const;
    Eigen::VectorXcd apply_inverse(const Eigen::VectorXcd& r) const;
    Eigen::VectorXcd load(const std::vector<int>& rows, const Eigen::VectorXcd& multipliers) const;
    void prepare_rows();
    Solver saddle_solver(const std::vector<int>& rows) const;
    Eigen::VectorXcd solve_rows(const Solver& solver, const std::vector<int>& rows, const Eigen::VectorXcd& d) const;
    double energy_of(const Eigen::VectorXcd& u) const;

    int order_;
    Eigen::VectorXcd rest_;
    double size_;
    Rig rig_;
    TriangleMesh mesh_;
    Binding binding_;
    Eigen::VectorXi component_;
    std::vector<int> held_;  // components with a hold, ascending
    SparseMatrix L_;
    Eigen::VectorXd M_;
    Eigen::VectorXd component_mass_;
    GroundedInverse inverse_;
    std::vector<Row> rows_;      // means of all holds, then vertices, then turns
    Eigen::MatrixXcd response_;  // of row i to a unit multiplier on row j
    Eigen::VectorXd scale_;  // brings the saddle system's rows to similar size; one a row, then one a held component
    std::vector<int> mean_rows_;  // 0, 1, ... : the rows of a pose without angles
    Solver mean_solver_;          // their saddle system
};

}  // namespace puppetwarp
