#pragma once

#include <puppetwarp/base/point.h>

#include <opencv2/core/mat.hpp>

#include <array>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace puppetwarp {

//! Moves the picture at a point: the weighted mean of a disc around `at` follows the target.
struct PointHandle {
    Point at;                         //!< image pixels
    std::optional<double> radius_px;  //!< of the disc; none: a fixed share of the subject's size
};

//! What a bone does whose ends are sent to places that are not its length apart.
enum class BoneLength {
    stretch,  //!< becomes as long as that, as a similarity
    fixed     //!< turns towards its end's target and keeps its length
};

std::string bone_length_name(BoneLength length);
//! \throw InvalidInput  unknown name (lists the known ones).
BoneLength bone_length_from_name(std::string_view name);

//! A segment that moves rigidly, or stretches, with its parents.
struct BoneHandle {
    Point from;
    Point to;
    std::string parent;  //!< id of another bone, or empty
    BoneLength length = BoneLength::stretch;
};

//! A closed polygon around or inside the subject whose corners are moved.
struct CageHandle {
    Polyline points;
};

//! How a region's motion fades outside of it in the methods that spread it as a field (ALGORITHMS.md section 2).
enum class Falloff {
    none,      //!< the method itself decides what lies between
    harmonic,  //!< d = s D, with Lap s = 0, s = 1 on the region and 0 on every other handle
    geodesic   //!< the same with a smooth function of the distances inside the subject
};

std::string falloff_name(Falloff falloff);
//! \throw InvalidInput  unknown name (lists the known ones).
Falloff falloff_from_name(std::string_view name);

//! A painted polygon: the mesh inside moves by one map, or stays where a pose does not name it.
struct RegionHandle {
    Polyline points;
    Falloff falloff = Falloff::none;
};

//! One vertex of a mesh that was given as a file.
struct VertexHandle {
    int index = 0;
};

struct Handle {
    std::string id;  //!< unique, not empty
    std::variant<PointHandle, BoneHandle, CageHandle, RegionHandle, VertexHandle> shape;
};

//! A polygon inside which first-order energies are multiplied by `value`.
struct StiffnessRegion {
    Polyline points;
    double value = 1;  //!< above 0
};

//! A grey picture over the source image: black multiplies first-order energies by 1, white by `max`, grey between.
struct StiffnessPicture {
    std::string path;     //!< relative to the puppet file
    double max = 1;       //!< above 0
    cv::Mat grey;         //!< CV_32FC1 in [0, 1], stretched over the source image; empty until it is loaded
    double width_px = 0;  //!< of the source image
    double height_px = 0;
};

using Stiffness = std::variant<StiffnessRegion, StiffnessPicture>;

//! What takes hold of a subject: all that a person placed on it, at rest.
struct Rig {
    std::vector<Handle> handles;
    std::vector<Stiffness> stiffness;  //!< their factors multiply
};

//! Where one handle goes. What is not set stays as it rests.
struct HandlePose {
    std::optional<Point> to;           //!< of a point or vertex, a bone's end, a region's centroid
    std::optional<Point> from;         //!< target of a bone's start
    std::optional<Polyline> points;    //!< targets of a cage's corners
    std::optional<double> rotate_rad;  //!< clockwise on screen; a point without it has a free angle
    std::optional<double> turn_rad;    //!< how far a free angle turned on its way here, whole turns counted
    std::optional<double> scale;       //!< above 0, at most a million
    std::optional<double> depth;       //!< larger is nearer to the viewer, at most a million: `vertex_depths`
    std::optional<Point> reach;        //!< of a bone's end, to which it and its parents bend: `reach`
    std::optional<int> chain;          //!< how many bones bend to reach, at least 1; none: two
    std::optional<std::array<double, 6>> affine;  //!< x' = a x + c y + e, y' = b x + d y + f
};

//! Targets for some handles of a rig; a handle that is not named stays where it rests.
struct Pose {
    std::string name;
    double time_s = 0;
    std::map<std::string, HandlePose> handles;  //!< by handle id
};

//! \return the handle with this id, or null.
const Handle* find_handle(const Rig& rig, const std::string& id);

//! Checks what does not depend on a mesh.
//! \throw InvalidInput  ids empty or used twice, a coordinate that is not finite, a radius, scale or stiffness that is
//!        not above 0, a bone's parent that is missing or leads round in a loop. Names the handle.
void require_sound(const Rig& rig);

//! \throw InvalidInput  a handle that the rig does not have, a value that is not finite or out of range, a field that
//! the
//!        handle's type does not have, fields that say the same twice.
void require_sound(const Pose& pose, const Rig& rig);

}  // namespace puppetwarp
