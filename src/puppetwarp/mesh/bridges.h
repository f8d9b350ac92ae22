#pragma once
// Private header.

#include <puppetwarp/mesh/segment_grid.h>

#include <vector>

namespace puppetwarp {

//! Points joined by edges, open or closed, of one connected component.
struct Strand {
    Polyline points;
    int component = 0;  //!< 0-based
};

//! The shortest segments from point to point that make all components one: a minimum spanning tree, which lies in the
//! Delaunay triangulation of the points.     Kruskal 1956; Shamos & Hoey 1975.
//! \param strands  finite points.
std::vector<Segment> bridges(const std::vector<Strand>& strands);

}  // namespace puppetwarp
