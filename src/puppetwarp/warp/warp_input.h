#pragma once

#include <puppetwarp/mesh/triangle_mesh.h>
#include <puppetwarp/warp/warp.h>

#include <opencv2/core/mat.hpp>

#include <cstdint>

namespace puppetwarp::detail {

//! Whether a coordinate is small enough for exact arithmetic with room to spare: up to 2^30 px.
bool is_within_reach(double coordinate);

//! \throw InvalidInput  a side below 1, more than 2^31 - 1 pixels.
void require_possible(std::int64_t width, std::int64_t height);

//! What is drawn, checked and brought within reach.
struct WarpInput {
    TriangleMesh rest;  //!< its triangles in the order in which they are painted
    Eigen::MatrixX2d moved;
    Canvas canvas;
};

//! Of the options, canvas and depths: a canvas of no size is the picture's own, `width` x `height`.
//! \throw InvalidInput  as `warp`.
WarpInput checked_input(const TriangleMesh& rest, const Eigen::MatrixX2d& moved, const WarpOptions& options, int width,
                        int height);

//! Pixels for a canvas, not filled. \throw MachineFault  not enough memory.
cv::Mat allocate_canvas(const Canvas& canvas, int type);

}  // namespace puppetwarp::detail
