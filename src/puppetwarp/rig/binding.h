#pragma once
// Private header: how handles take hold of a mesh.

#include <puppetwarp/mesh/triangle_mesh.h>
#include <puppetwarp/rig/rig.h>

#include <complex>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace puppetwarp {

//! A point's disc by default, as a share of the bounding diagonal of the subject.
inline constexpr double default_disc_share = 0.03;
//! A point this share of the bounding diagonal outside is on the border: nobody can place it better.
inline constexpr double on_border = 1e-9;
//! Points nearer than this share of the bounding diagonal are in one place: half a pixel of a thousand.
inline constexpr double one_place = 5e-4;
//! Vertices are told apart by their index, at any density; nearer than this share is the same vertex.
inline constexpr double one_vertex = 1e-9;
//! Targets may lie this many bounding diagonals away; beyond, numbers lose what the mesh is made of.
inline constexpr double farthest_move = 1e6;

//! A linear function of the vertex positions, these written as complex numbers: sum of coefficient * position.
using ComplexRow = std::vector<std::pair<int, std::complex<double>>>;

//! How one handle takes hold of a mesh.
struct Hold {
    std::string id;
    std::complex<double> at;  //!< the handle's own place at rest
    int component = 0;        //!< of the mesh, that it moves
    bool hard = false;        //!< one vertex, given by its index
    ComplexRow mean;          //!< weighted mean of the positions it holds; real weights above 0, sum 1
    ComplexRow turn;          //!< mean of f_z over what it holds: s e^(i theta) for a similarity; empty when hard
    double radius_px = 0;     //!< length that makes `turn` comparable with `mean`
};

//! Where one hold goes.
struct HoldTarget {
    std::complex<double> move;         //!< by which its mean is displaced
    std::optional<double> rotate_rad;  //!< of its turn; none: free
    std::optional<double> scale;       //!< only with rotate_rad; none: free where the method can, else 1
};

//! Takes hold of a mesh with points and vertices. A point holds the vertices of its disc that are connected to it
//! inside the disc, weighted by area times (1 - (d / r)^2)^2 and tilted so that their mean is the point
//! itself where the outline leaves enough of the disc; a disc that is too small for the mesh falls back to
//! the triangle below the point.
//! \param user  who asks, for messages: a method's name.
//! \throw InvalidInput  no handles, handles of other types, a point outside the mesh, an index out of range.
std::vector<Hold> take_hold(const TriangleMesh& mesh, const Rig& rig, std::string_view user);

//! Targets in the order of the holds; a hold that the pose does not name stays.
//! \param size  bounding diagonal of the mesh.
//! \throw InvalidInput  `require_sound(pose, rig)`; an affine map; a scale without an angle; two holds in one place
//!        that are sent to different ones; a target too far away.
std::vector<HoldTarget> resolve(const std::vector<Hold>& holds, const Rig& rig, const Pose& pose, double size,
                                std::string_view user);

//! Factor of each triangle's share in first-order energies: the product of the regions that hold its centroid. #F, or
//! empty when there are no regions.
Eigen::VectorXd triangle_stiffness(const TriangleMesh& mesh, const std::vector<StiffnessRegion>& regions);

//! \throw InvalidInput  always: the point handle `id` lies `distance_px` outside the subject.
[[noreturn]] void throw_outside(const std::string& id, double distance_px);

//! Value of a row at positions x.
std::complex<double> row_value(const ComplexRow& row, const Eigen::VectorXcd& x);

//! Positions as complex numbers, x + i y, and back. #V
Eigen::VectorXcd complex_positions(const Eigen::MatrixX2d& V);
Eigen::MatrixX2d point_positions(const Eigen::VectorXcd& x);

}  // namespace puppetwarp
