#pragma once
// Private header.

#include <puppetwarp/weights/weight_problem.h>

namespace puppetwarp {

//! Biharmonic weights without extrema away from what is given (Weinkauf, Gingold & Sorkine 2011; Jacobson, Weinkauf &
//! Sorkine 2012): least Laplacian energy such that every free vertex has a neighbour with no more and one with no less.
//! Which ones is read off a function that has no extrema, the harmonic one with positive edge weights; then once more
//! off the solution, whose energy can only fall. Each handle on its own, at last rows are divided by their sums, which
//! alone may bring back small extrema (as in the paper).
//! The minimisation is convex; it is left to an interior point method instead of the paper's conic solver.
//! \param progress  hears of `weights`, handle by handle.   \throw Cancelled
//! \throw InvalidInput  the mesh's triangles are too bad to factorise.
WeightSolution monotonic_weights(const WeightProblem& problem, const WeightOptions& options, Progress& progress);

//! The same before rows are divided by their sums. #V x #columns
WeightSolution monotonic_functions(const WeightProblem& problem, const WeightOptions& options, Progress& progress);

}  // namespace puppetwarp
