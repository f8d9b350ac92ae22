#pragma once

#include <puppetwarp/base/point.h>

#include <vector>

namespace puppetwarp {

//! Where a closed curve may pass: anywhere between two points. `inner` lies on the right of the way, seen on screen.
struct Gate {
    Point inner, outer;
    Point middle;  //!< where it most likely passes
    bool wide;     //!< the middle is a mere guess
};

//! A bend of the shortest curve through the gates.
struct Bend {
    std::size_t gate;
    Point at;
};

//! The bends of the shortest closed curve that passes all gates in order; fewer than three when it does not
//! settle (a contour of a few gates).   Lee & Preparata 1984, the funnel algorithm.
std::vector<Bend> taut_string(const std::vector<Gate>& gates);

//! The polygon through the gates with straight pieces where the gates allow: the taut string finds the pieces, a line
//! fitted to the middles of each piece's gates places it, so that convex shapes do not shrink.
Polyline straightened(const std::vector<Gate>& gates);

}  // namespace puppetwarp
