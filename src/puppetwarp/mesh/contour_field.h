#pragma once

#include <puppetwarp/base/point.h>

#include <array>
#include <cstdint>
#include <vector>

namespace puppetwarp {

//! A sampled function whose zero set is wanted: positive inside, one signed byte a node, never 0, so that every
//! contour crosses grid edges strictly between nodes and contours can neither touch nor miss a node's side.
//! Node (i, j) stands at (x0 + i, y0 + j). The outermost nodes are outside.
class ContourField {
public:
    static constexpr int scale = 127;  //!< the stored value of 1

    //! All nodes outside.  \pre columns, rows at least 3
    ContourField(double x0, double y0, int columns, int rows);

    int columns() const { return columns_; }
    int rows() const { return rows_; }
    double x0() const { return x0_; }
    double y0() const { return y0_; }
    std::int8_t* row(int j) {
        return values_.data() + static_cast<std::size_t>(j) * static_cast<std::size_t>(columns_);
    }
    const std::int8_t* row(int j) const {
        return values_.data() + static_cast<std::size_t>(j) * static_cast<std::size_t>(columns_);
    }
    bool inside(int i, int j) const { return row(j)[i] > 0; }

private:
    double x0_, y0_;
    int columns_, rows_;
    std::vector<std::int8_t> values_;
};

//! One place where a contour crosses a grid edge.
struct Crossing {
    int i, j;          //!< the node inside
    std::uint8_t way;  //!< where the node outside is: 0 right, 1 down, 2 left, 3 up
    float at;          //!< share of the way from inside to outside, in (0, 1)
};

//! Steps from a node to its neighbour, by `Crossing::way`.
inline constexpr std::array<std::array<int, 2>, 4> grid_steps{{{1, 0}, {0, 1}, {-1, 0}, {0, -1}}};

//! Where the crossing is, in the field's coordinates.
Point crossing_point(const ContourField& field, const Crossing& crossing, double at);
inline Point crossing_point(const ContourField& field, const Crossing& crossing) {
    return crossing_point(field, crossing, crossing.at);
}

//! A closed contour: positive area (x right, y down) around what is inside, negative area around holes.
using Contour = std::vector<Crossing>;

//! All contours of the zero set, in the order of their first rows; marching squares, diagonal neighbours inside are
//! apart. No two contours touch.   Lorensen & Cline 1987, in the plane.
std::vector<Contour> trace_contours(const ContourField& field);

}  // namespace puppetwarp
