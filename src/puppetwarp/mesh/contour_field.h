#pragma once

#include <puppetwarp/base/point.h>

#include <array>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <vector>

namespace puppetwarp {

//! A sampled function whose zero set is wanted: one signed byte a node, positive inside, negative outside, 0 far
//! outside. Every contour crosses grid edges strictly between nodes, so that contours never touch.
//! Node (i, j) stands at (x0 + i, y0 + j). The outermost nodes are outside. Memory that is never written to is never
//! taken: most of a picture is far outside.
class ContourField {
public:
    static constexpr int scale = 127;  //!< the stored value of 1

    //! All nodes far outside.  \pre columns, rows at least 3
    ContourField(double x0, double y0, int columns, int rows);

    int columns() const { return columns_; }
    int rows() const { return rows_; }
    double x0() const { return x0_; }
    double y0() const { return y0_; }
    std::int8_t* row(int j) { return values_.get() + static_cast<std::size_t>(j) * static_cast<std::size_t>(columns_); }
    const std::int8_t* row(int j) const {
        return values_.get() + static_cast<std::size_t>(j) * static_cast<std::size_t>(columns_);
    }
    bool inside(int i, int j) const { return row(j)[i] > 0; }
    //! What a stored value stands for: far outside counts as one unit outside.
    static std::int8_t value(std::int8_t stored) { return stored == 0 ? -scale : stored; }

private:
    double x0_, y0_;
    int columns_, rows_;
    struct Free {
        void operator()(std::int8_t* values) const { std::free(values); }
    };
    std::unique_ptr<std::int8_t[], Free> values_;
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
