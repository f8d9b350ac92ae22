#pragma once

#include <puppetwarp/deform/deformer.h>

#include <vector>

// As-rigid-as-possible deformation as the papers write it: one edge at a time, rotations by singular value
// decomposition, local and global steps in turn. Slow and plain, for tests and as the benches' yardstick.
namespace puppetwarp::reference {

//! An edge seen from one cell: w |(x_j - x_i) - R (p_j - p_i)|^2.
struct CellEdge {
    int i;
    int j;
    double w;
};

//! The cells of an energy: triangles (Liu et al. 2008), or one a vertex (Sorkine & Alexa 2007, Chao et al. 2010).
std::vector<std::vector<CellEdge>> arap_cells(const TriangleMesh& mesh, ArapEnergy energy);

//! The energy at positions x, #V x 2, with the best rotation of each cell.
double arap_energy(const TriangleMesh& mesh, ArapEnergy energy, const Eigen::MatrixX2d& x);

//! Local/global from `start` with some vertices held at their start positions, until a step changes no
//! coordinate by more than `step`, at most `iterations` times.
Eigen::MatrixX2d local_global(const TriangleMesh& mesh, ArapEnergy energy, const std::vector<int>& held,
                              const Eigen::MatrixX2d& start, double step, int iterations);

}  // namespace puppetwarp::reference
