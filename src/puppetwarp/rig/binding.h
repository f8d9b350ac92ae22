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

//! z -> alpha z + beta conj(z) + shift: the affine maps of the plane, f_z = alpha and f_zbar = beta.
struct AffineMap {
    std::complex<double> alpha = 1;
    std::complex<double> beta = 0;
    std::complex<double> shift = 0;

    std::complex<double> operator()(std::complex<double> z) const { return alpha * z + beta * std::conj(z) + shift; }
};

//! A weighted mean of vertex positions that a handle moves: a point's disc, or one of the discs along a bone.
struct Hold {
    int handle = 0;           //!< index in Rig::handles
    std::complex<double> at;  //!< its place at rest
    int component = 0;        //!< of the mesh, that it moves
    ComplexRow mean;          //!< weighted mean of the positions it holds; real weights above 0, sum 1
    ComplexRow turn;          //!< mean of f_z over what it holds: s e^(i theta) for a similarity; empty along bones
    ComplexRow shear;         //!< mean of f_zbar over the same; empty along bones
    double radius_px = 0;     //!< length that makes `turn` and `shear` comparable with `mean`
};

//! A vertex that a handle holds by itself: given by its index, or inside a region.
struct HeldVertex {
    int handle = 0;  //!< index in Rig::handles
    int vertex = 0;
};

//! Two handles in one place, which they must send to one.
struct Meeting {
    int first = 0;  //!< index in Rig::handles
    int second = 0;
    std::complex<double> first_place;  //!< of each, at rest
    std::complex<double> second_place;
    double near_px = 0;   //!< their moves may differ by this
    bool vertex = false;  //!< whether what they share is a vertex that both hold
    int hold = -1;        //!< the one Hold of two points in the same place, which moves as both say; else -1
};

//! How a rig takes hold of a mesh. Nothing is held twice in the same way: what a handle shares with an earlier one is
//! the earlier one's alone (a point's before a bone's, whose end it pins), and a Meeting.
struct Binding {
    std::vector<Hold> holds;           //!< in the order of the handles
    std::vector<HeldVertex> vertices;  //!< ascending, each vertex once
    std::vector<Meeting> meetings;
    std::vector<bool> loose;  //!< #V: whether a vertex is of a component that no handle holds; these stay
    std::vector<std::string> warnings;
};

//! Where one hold goes.
struct HoldTarget {
    std::complex<double> move;         //!< by which its mean is displaced
    std::optional<double> rotate_rad;  //!< of its turn; none: free
    std::optional<double> scale;       //!< of its turn; none: free where the method can, else 1
    std::optional<std::complex<double>>
        shear;                       //!< of an affine map: the value of `shear`; then angle and scale are set
    std::optional<double> turn_rad;  //!< how far the free angle turned on its way, whole turns counted
};

//! Where everything that is held goes.
struct Targets {
    std::vector<HoldTarget> holds;  //!< in the order of Binding::holds
    Eigen::VectorXcd vertices;      //!< positions, in the order of Binding::vertices
    std::vector<AffineMap> maps;    //!< of each handle of the rig: how it moves as a whole
};

//! Takes hold of a mesh with points, bones, regions and vertices. A point holds the vertices of its disc that are
//! connected to it inside the disc, weighted by area times (1 - (d / r)^2)^2 and tilted so that their mean is the point
//! itself where the outline leaves enough of the disc; a disc that is too small for the mesh falls back to
//! the triangle below the point. A bone holds such discs along itself, not more than a radius apart, where there is a
//! subject between its ends. A region holds the vertices inside.
//! \param user  who asks, for messages: a method's name.
//! \throw InvalidInput  no handles, a cage, a point or a bone's end outside the mesh, an index out of range, a region
//!        without a vertex inside.
Binding take_hold(const TriangleMesh& mesh, const Rig& rig, std::string_view user);

//! Whether a method can move a handle by any affine map.
enum class AffineUse { yes, no };

//! Targets of all that is held; a handle that the pose does not name stays, a bone with its parent. A point moves the
//! mean of its disc by `to - at`; by an affine map, and along bones, the mean goes where the map takes it. A region
//! turns and scales about its centroid, which goes to `to`. \param mesh    that `binding` was made of. \throw
//! InvalidInput  `require_sound(pose, rig)`; a point's affine map for who has no use for it; two handles in one
//!        place, or on one vertex, that are sent to different ones; a target too far away.
Targets resolve(const Binding& binding, const TriangleMesh& mesh, const Rig& rig, const Pose& pose, AffineUse affine,
                std::string_view user);

//! Factor of each triangle's share in first-order energies: the product of the regions that hold its centroid and of
//! the pictures there. #F, or empty when there is no stiffness.
Eigen::VectorXd triangle_stiffness(const TriangleMesh& mesh, const std::vector<Stiffness>& stiffness);

//! \throw InvalidInput  always: the point handle `id` lies `distance_px` outside the subject.
[[noreturn]] void throw_outside(const std::string& id, double distance_px);

//! Value of a row at positions x.
std::complex<double> row_value(const ComplexRow& row, const Eigen::VectorXcd& x);

//! Positions as complex numbers, x + i y, and back. #V
Eigen::VectorXcd complex_positions(const Eigen::MatrixX2d& V);
Eigen::MatrixX2d point_positions(const Eigen::VectorXcd& x);

}  // namespace puppetwarp
