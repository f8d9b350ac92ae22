#pragma once
// Private header.

#include <puppetwarp/mesh/segment_grid.h>

#include <Eigen/Geometry>

#include <vector>

namespace puppetwarp {

//! Distance between two segments; 0 where they cross.
double segment_distance(const Segment& s, const Segment& t);

//! A closed polygon that others keep away from.
class Clearance {
public:
    //! \param polygon  any closed polygon, not empty.
    explicit Clearance(const Polyline& polygon);

    //! Whether a segment stays at least `distance` away from every edge of the polygon.
    bool keeps(const Segment& s, double distance) const;

private:
    struct Run {
        std::size_t first, last;  // edges
        Eigen::AlignedBox2d box;
    };
    std::vector<Segment> edges_;
    std::vector<Run> runs_;  // of neighbouring edges: a box far away stands for all of them
};

}  // namespace puppetwarp
