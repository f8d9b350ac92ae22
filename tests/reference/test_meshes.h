#pragma once

#include <puppetwarp/mesh/triangle_mesh.h>
#include <puppetwarp/rig/rig.h>

#include <Eigen/Geometry>

#include <complex>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

// Meshes that tests and benches make for themselves, without the project's own mesher.
namespace puppetwarp::reference {

//! nx x ny squares over [0, width] x [0, height], each cut in two along alternating diagonals; inner vertices moved by
//! up to `jitter` of a square (below 0.3, so that nothing flips). Vertex (i, j) has index j * (nx + 1) + i.
TriangleMesh grid(int nx, int ny, double width, double height, double jitter = 0, std::uint32_t seed = 1);

//! `rings` x `sectors` quadrilaterals between two circles about (0, 0), radii in geometric progression, each cut in
//! two. Vertex (ring r, sector s) has index r * sectors + s.
TriangleMesh annulus(int rings, int sectors, double inner, double outer);

//! Triangles of about `edge` over the points where `inside` holds, within [0, size] x [0, size]; the largest connected
//! part. Deterministic for a seed.
TriangleMesh shape(const std::function<bool(double x, double y)>& inside, double size, double edge,
                   std::uint32_t seed = 1);

//! A figure with a head, two arms and two legs, `size` pixels high, head up.
TriangleMesh figure(double size, double edge);
//! Points of `figure` in shares of its size.
namespace figure_places {
inline const Point head{0.5, 0.15}, left_hand{0.06, 0.16}, right_hand{0.94, 0.56}, left_foot{0.34, 0.94},
    right_foot{0.69, 0.94}, chest{0.5, 0.45}, right_shoulder{0.58, 0.45}, belly{0.5, 0.66};
}

//! A star-shaped outline with a random smooth radius, about `size` pixels wide.
TriangleMesh blob(double size, double edge, std::uint32_t seed);

//! Two meshes side by side in one, the second moved by `offset`.
TriangleMesh joined(const TriangleMesh& a, const TriangleMesh& b, const Point& offset);

//! The nearest vertex to a point.
int nearest_vertex(const TriangleMesh& mesh, const Point& p);

//! A rig of points p0, p1, ... at these places.
Rig rig_of_points(const std::vector<Point>& places);
//! A rig of vertices v0, v1, ... of these indices.
Rig rig_of_vertices(const std::vector<int>& indices);

//! The id of the k-th of them.
std::string vertex_id(std::size_t k);

//! How much the disc of `radius` about a point turned and grew, s e^(i theta) for a similarity: the mean of its
//! triangles' maps, weighted by area times (1 - (d / radius)^2)^2 at their centroids.
std::complex<double> mean_turn(const TriangleMesh& mesh, const Eigen::MatrixX2d& moved, const Point& at, double radius);

//! The rotation by `angle_rad` clockwise on screen about `centre`, then the move.
Point rigid(const Point& p, const Point& centre, double angle_rad, const Point& move);

}  // namespace puppetwarp::reference
