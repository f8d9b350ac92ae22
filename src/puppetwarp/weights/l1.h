#pragma once
// Private header.

#include <puppetwarp/weights/weight_problem.h>

namespace puppetwarp {

//! Bounded biharmonic weights with a budget of their L1 norm, which makes them vanish away from their handle (after
//! Rustamov 2011, Multiscale biharmonic kernels): each minimises 1/2 w^T Q w over 0 <= w <= 1 such that its integral
//! over what is free is at most `l1_budget` times what it is without the budget. As w >= 0 the norm is a linear term,
//! whose multiplier is found by a safeguarded search for the root of a monotone function.
//! The bounds, the budget as a share and the division of rows by their sums at the end are ours; the paper has a kernel
//! about a point, of either sign, with a budget in absolute units.
//! \param progress  hears of `weights`, handle by handle.   \throw Cancelled
//! \throw InvalidInput  the mesh's triangles are too bad to factorise.
WeightSolution l1_weights(const WeightProblem& problem, const WeightOptions& options, Progress& progress);

//! The same before rows are divided by their sums. #V x #columns
WeightSolution l1_functions(const WeightProblem& problem, const WeightOptions& options, Progress& progress);

}  // namespace puppetwarp
