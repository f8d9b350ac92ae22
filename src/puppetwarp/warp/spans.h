#pragma once

#include <puppetwarp/mesh/triangle_mesh.h>
#include <puppetwarp/warp/warp.h>

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

namespace puppetwarp::detail {

//! A corner on the sub-pixel grid, relative to the canvas' corner.
struct SnappedPoint {
    std::int64_t x = 0;
    std::int64_t y = 0;
};

//! Which pixel centres a triangle holds, decided exactly.
//!
//! Corners are snapped to 1/65536 px; from there on everything is integer arithmetic without rounding, so that a
//! centre belongs to exactly one triangle of a mesh without overlaps, whatever the triangles' sizes and shapes. A
//! centre on an edge belongs to the triangle on its right; on a horizontal edge to the one below.
inline constexpr int subpixel_bits = 16;
inline constexpr std::int64_t subpixel_one = std::int64_t{1} << subpixel_bits;
inline constexpr std::int64_t subpixel_half = subpixel_one / 2;

//! A coordinate on the sub-pixel grid, relative to `origin`.
std::int64_t snapped(double coordinate, int origin);

//! First pixel whose centre is not left of (not above) a snapped coordinate.
inline std::int64_t first_centre(std::int64_t coordinate) {
    return (coordinate + subpixel_half - 1) >> subpixel_bits;
}

//! Where an edge crosses the rows of pixel centres, from one row to the next below, exactly.
//! \tparam Int  wide enough for products of two coordinates.
template <class Int>
class EdgeWalker {
public:
    //! \param upper,lower  ends of the edge, upper.y < lower.y.
    EdgeWalker(SnappedPoint upper, SnappedPoint lower, std::int64_t row) {
        const Int dx = lower.x - upper.x;
        const Int dy = lower.y - upper.y;
        const Int centre = Int(row) * subpixel_one + subpixel_half;
        const Int numerator = (Int(upper.x) - subpixel_half) * dy + (centre - upper.y) * dx;
        denominator_ = dy * subpixel_one;
        column_ = numerator / denominator_;
        remainder_ = column_ * denominator_ - numerator;
        if (remainder_ < 0) {
            remainder_ += denominator_;
            ++column_;
        }
        step_ = dx / dy;
        Int rest = dx - step_ * dy;
        if (rest < 0) {
            rest += dy;
            --step_;
        }
        step_remainder_ = rest * subpixel_one;
    }

    //! First pixel of the row whose centre is not left of the edge.
    std::int64_t column() const { return static_cast<std::int64_t>(column_); }

    void next_row() {
        column_ += step_;
        remainder_ -= step_remainder_;
        if (remainder_ < 0) {
            remainder_ += denominator_;
            ++column_;
        }
    }

private:
    // The crossing is at column_ - remainder_ / denominator_, 0 <= remainder_ < denominator_.
    Int column_, remainder_, denominator_, step_, step_remainder_;
};

//! Rows [first, last) of the canvas.
struct RowRange {
    int first = 0;
    int last = 0;
};

__extension__ typedef __int128 Int128;

//! Twice the signed area of a snapped triangle; its sign is exact.
inline Int128 snapped_double_area(SnappedPoint a, SnappedPoint b, SnappedPoint c) {
    return Int128(b.x - a.x) * (c.y - a.y) - Int128(b.y - a.y) * (c.x - a.x);
}

template <class Int, class Body>
void walk_rows(SnappedPoint long_upper, SnappedPoint long_lower, SnappedPoint upper, SnappedPoint lower,
               bool long_is_left, RowRange rows, int width, const Body& body) {
    if (rows.first >= rows.last) return;
    EdgeWalker<Int> left(long_upper, long_lower, rows.first);
    EdgeWalker<Int> right(upper, lower, rows.first);
    if (!long_is_left) std::swap(left, right);
    for (int row = rows.first; row < rows.last; ++row) {
        const std::int64_t first = std::max<std::int64_t>(left.column(), 0);
        const std::int64_t last = std::min<std::int64_t>(right.column(), width);
        if (first < last) body(row, static_cast<int>(first), static_cast<int>(last));
        left.next_row();
        right.next_row();
    }
}

//! Calls `body(row, first, last)` for the pixels [first, last) of each row in `rows` whose centres lie in a triangle.
template <class Body>
void for_each_span(SnappedPoint a, SnappedPoint b, SnappedPoint c, RowRange rows, int width, const Body& body) {
    if (b.y < a.y) std::swap(a, b);
    if (c.y < b.y) std::swap(b, c);
    if (b.y < a.y) std::swap(a, b);
    const auto clip = [&](std::int64_t first, std::int64_t last) {
        return RowRange{static_cast<int>(std::clamp<std::int64_t>(first, rows.first, rows.last)),
                        static_cast<int>(std::clamp<std::int64_t>(last, rows.first, rows.last))};
    };
    const RowRange above = clip(first_centre(a.y), first_centre(b.y));
    const RowRange below = clip(first_centre(b.y), first_centre(c.y));
    const auto small = [](SnappedPoint p) {
        constexpr std::int64_t limit = std::int64_t{1} << 30;
        return std::max(std::abs(p.x), std::abs(p.y)) < limit;
    };
    const bool long_is_left = snapped_double_area(a, c, b) < 0;
    if (small(a) && small(b) && small(c)) {
        walk_rows<std::int64_t>(a, c, a, b, long_is_left, above, width, body);
        walk_rows<std::int64_t>(a, c, b, c, long_is_left, below, width, body);
    } else {
        walk_rows<Int128>(a, c, a, b, long_is_left, above, width, body);
        walk_rows<Int128>(a, c, b, c, long_is_left, below, width, body);
    }
}

//! The moved triangles of a mesh over a canvas, ready to be walked row by row.
class SnappedMesh {
public:
    //! \param moved  finite, below 2^30 px.
    SnappedMesh(const TriangleMesh& rest, const Eigen::MatrixX2d& moved, const Canvas& canvas,
                BackFaces back_faces = BackFaces::hide);

    int triangle_count() const { return static_cast<int>(rows_.size()); }
    const Canvas& canvas() const { return canvas_; }
    SnappedPoint corner(int triangle, int k) const { return points_[static_cast<std::size_t>(faces_(triangle, k))]; }
    //! False for triangles without area, and for flipped ones when these are hidden.
    bool drawn(int triangle) const { return shows(triangle) != Shows::nothing; }
    //! Whether a triangle that is drawn is flipped.
    bool flipped(int triangle) const { return shows(triangle) == Shows::back; }
    //! Rows in which a triangle may have pixels; none when it is not drawn, or beside the canvas.
    RowRange rows(int triangle) const { return rows_[static_cast<std::size_t>(triangle)]; }

    //! `body(row, first, last)` for the pixels of a triangle within `band`.
    template <class Body>
    void for_each_span_of(int triangle, RowRange band, const Body& body) const {
        const RowRange own = rows(triangle);
        const RowRange both{std::max(own.first, band.first), std::min(own.last, band.last)};
        if (both.first >= both.last) return;
        for_each_span(corner(triangle, 0), corner(triangle, 1), corner(triangle, 2), both, canvas_.width, body);
    }

    //! `body(triangle)` in the order of the triangles, for those that may have pixels in `band`, or parts of pixels.
    template <class Body>
    void for_each_triangle_in(RowRange band, const Body& body) const {
        // A triangle reaches at most a row beyond those whose centres it may hold.
        const auto meets = [&](RowRange rows) { return rows.first <= band.last && band.first <= rows.last; };
        for (int block = 0; block * block_triangles < triangle_count(); ++block) {
            if (!meets(block_rows_[static_cast<std::size_t>(block)])) continue;
            const int last = std::min((block + 1) * block_triangles, triangle_count());
            for (int triangle = block * block_triangles; triangle < last; ++triangle) {
                if (drawn(triangle) && meets(rows(triangle))) body(triangle);
            }
        }
    }

    //! True when every pixel of the canvas is held by some triangle.
    bool covers_canvas() const;
    //! How many triangles hold the first pixel: as many as hold any, when no border passes through the canvas.
    int layers_on_first_pixel() const;

private:
    enum class Shows : std::uint8_t { nothing, front, back };
    Shows shows(int triangle) const { return shows_[static_cast<std::size_t>(triangle)]; }
    Shows what_shows(int triangle, const Eigen::MatrixX2d& rest) const;
    RowRange rows_of(int triangle) const;
    bool covers(RowRange band) const;

    const Eigen::MatrixX3i& faces_;
    Canvas canvas_;
    BackFaces back_faces_;
    std::vector<SnappedPoint> points_;
    std::vector<Shows> shows_;
    std::vector<RowRange> rows_;
    // Neighbours in a mesh mostly have indices close to each other: whole blocks of them lie beside a band.
    static constexpr int block_triangles = 32;
    std::vector<RowRange> block_rows_;
};

}  // namespace puppetwarp::detail
