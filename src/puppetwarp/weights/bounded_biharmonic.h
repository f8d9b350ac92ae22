#pragma once
// Private header.

#include <puppetwarp/weights/weight_problem.h>

namespace puppetwarp {

//! Bounded biharmonic weights (Jacobson, Baran, Popovic & Sorkine 2011): least Laplacian energy between 0 and 1.
//! `Partition::coupled` minimises over all handles at once with rows that sum to 1, as the paper states the problem;
//! `Partition::normalised` over each handle on its own, then rows are divided by their sums, as the paper's authors do
//! in practice. Q, with local stiffness, is `laplacian_energy`.
//! Deviations from the paper: solved to the tolerance by active sets, from coarse meshes to fine, each starting from
//! what the one before holds at its bounds; mixed Voronoi areas for the mass.
//! The KKT residual is that of the weights returned; with `Partition::normalised`, before the division.
//! \param progress  hears of `weights`; may cancel.
//! \throw InvalidInput  the mesh's triangles are too bad to factorise.   \throw Cancelled
WeightSolution bounded_biharmonic_weights(const WeightProblem& problem, const WeightOptions& options,
                                          Progress& progress);

//! The same, each handle on its own, before rows are divided by their sums. #V x #columns
WeightSolution bounded_biharmonic_functions(const WeightProblem& problem, const WeightOptions& options,
                                            Progress& progress);

}  // namespace puppetwarp
