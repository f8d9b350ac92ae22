#pragma once

#include <puppetwarp/base/point.h>

#include <cstddef>
#include <optional>
#include <utility>
#include <vector>

namespace puppetwarp {

struct Segment {
    Point a, b;
};

//! True when the segments share a point, or come so close that double precision cannot tell. A common endpoint,
//! exactly equal, does not count unless they overlap beyond it.
bool segments_meet(const Segment& s, const Segment& t);

//! Where two segments that meet do so; the middle of the first where they overlap.
Point meeting_point(const Segment& s, const Segment& t);

//! All pairs of segments that meet, each once, lower index first, sorted. A uniform grid keeps this about linear for
//! outlines.
std::vector<std::pair<std::size_t, std::size_t>> meeting_pairs(const std::vector<Segment>& segments);

}  // namespace puppetwarp
