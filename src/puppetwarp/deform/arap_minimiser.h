#pragma once
// Private header.

#include <puppetwarp/base/progress.h>
#include <puppetwarp/deform/arap_system.h>

#include <vector>

namespace puppetwarp {

//! When to stop.
struct ArapStop {
    double tolerance;  //!< relative: what is left to gain, and what the last step gained, against the energy
    int max_iterations;
    double energy_floor;  //!< energies below are round-off, px^2
};

struct ArapMinimum {
    int iterations = 0;
    bool converged = false;
    std::vector<double> energy_history;  //!< from the start on, never rising
};

//! Brings x onto C x = d by one Newton step of the constrained problem, however far that is, then exactly.
void step_onto(const ArapSystem& system, const ArapCells& cells, const ConstraintSpace& constraints,
               const ArapSystem::Factor& factor, const Eigen::VectorXd& d, Eigen::VectorXcd& x);

//! Minimises the energy over the unknowns within the constraints that x meets. L-BFGS over eight steps, its metric a
//! factor of the exact Hessian that is made anew when progress slows; Armijo's rule.   ALGORITHMS.md section 4.
//! \param factor  of the Hessian at x or near it; replaced by newer ones.
//! \throw Cancelled
ArapMinimum minimise(const ArapSystem& system, const ArapCells& cells, const ConstraintSpace& constraints,
                     const ArapStop& stop, ArapSystem::Factor& factor, Eigen::VectorXcd& x, Progress& progress);

}  // namespace puppetwarp
