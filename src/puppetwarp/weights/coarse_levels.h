#pragma once
// Private header.

#include <puppetwarp/weights/weight_problem.h>

#include <vector>

namespace puppetwarp {

//! A minimisation on a coarser mesh of about the same domain.
struct CoarseLevel {
    WeightProblem problem;
    //! #V of the next finer mesh x #V of this one: brings weights there. Rows are barycentric coordinates.
    SparseMatrix carry;
};

//! The same problem on meshes with edges 2, 4, 8, ... times as long, for guesses of what its weights are: their domains
//! are within a part of an edge of the mesh's, and what handles hold is moved to the nearest coarse vertices. Made from
//! the mesh alone: its boundary loops are thinned out and triangulated.
//! \return from the finest to the coarsest; empty or fewer where the mesh is small already, or where its boundary
//!         cannot be thinned out (it touches or overlaps itself, holes as small as the edges).
std::vector<CoarseLevel> coarse_levels(const WeightProblem& problem);

}  // namespace puppetwarp
