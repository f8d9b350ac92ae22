#pragma once

#include <puppetwarp/warp/spans.h>

#include <span>
#include <vector>

namespace puppetwarp::detail {

//! An edge with a drawn triangle on one side only. A fold is two, when both of its triangles are drawn.
struct BorderEdge {
    int triangle;
    SnappedPoint a, b;
    bool fold;  //!< the mesh goes on behind it, in a triangle that is flipped
};

//! Edges of a moved mesh that pass through the canvas and have one drawn triangle, or one that is flipped and one that
//! is not: its border, and folds. Edges whose ends lie in the same places as those of another one (a mesh that was cut
//! apart) are none.
std::vector<BorderEdge> border_edges(const Eigen::MatrixX3i& faces, const SnappedMesh& mesh);

//! A pixel of which a mesh covers a part.
struct BorderPixel {
    int triangle;  //!< that it is painted with: the one that holds its centre, else the one that covers most of it
    int row, x;
    float coverage;  //!< in [0, 1]
    bool holds_centre;
    bool at_fold;  //!< a fold is what crosses it
};

//! Pixels that the border of a mesh crosses, in the order of triangles, rows and columns.
//!
//! Coverage is the area of the pixel within a part of the mesh: the triangles that can be reached from a border edge's
//! over edges that two of them share, without leaving the pixel or passing a fold. So what lies over or under that part
//! does not count. A pixel has an entry for each such part; that of a part under others is its share of what these
//! leave open.
class BorderPixels {
public:
    BorderPixels() = default;
    //! \param frame  see `WarpOptions`.
    BorderPixels(const Eigen::MatrixX3i& faces, const SnappedMesh& mesh, const std::vector<BorderEdge>& edges,
                 const Eigen::AlignedBox2d& frame = {});

    bool empty() const { return pixels_.empty(); }
    //! Those of one triangle.
    std::span<const BorderPixel> of(int triangle) const;

private:
    std::vector<BorderPixel> pixels_;
    std::vector<std::size_t> starts_;  // of each triangle, and the end
};

}  // namespace puppetwarp::detail
