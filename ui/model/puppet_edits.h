#pragma once

#include <puppetwarp/project/puppet.h>

#include <map>
#include <string>
#include <vector>

namespace puppetwarp::ui {

// What a person does to a puppet, one function a deed; all else of the document stays as it is.

//! A pin: the id of a point handle and the two places it has, in image pixels.
struct Pin {
    std::string id;
    Point at;  //!< at rest
    Point to;  //!< in the pose
};

//! The point handles in the order of the rig, with their targets in `pose`.
std::vector<Pin> pins(const Puppet& puppet, const Pose& pose);

//! The pose of this name, an empty one of this name when there is none.
Pose pose_or_rest(const Puppet& puppet, const std::string& name);

//! Adds a pin that rests at `at` and is at `to` in the pose; the pose is made when it is needed and missing.
//! \return the id it got, unlike all others.
std::string add_pin(Puppet& puppet, const std::string& pose, const Point& at, const Point& to);

//! Sets a pin's target; the pose is made when it is missing.
void move_pin(Puppet& puppet, const std::string& pose, const std::string& id, const Point& to);

//! The pose with how far points with a free angle turned on their way, in whole degrees, when one of them turned so far
//! that the command could not know; without, when none did.
//! \param turns  by handle id, radians, as `InteractiveSolver::turns`; empty: the method follows none, and what the
//! pose
//!               says stays.
Pose with_turns(Pose pose, const std::map<std::string, double>& turns);

//! Makes a pose `with_turns`; one that is missing is made when it is needed.
void keep_turns(Puppet& puppet, const std::string& pose, const std::map<std::string, double>& turns);

//! Removes a handle from the rig and from every pose; bones that hung on it stand alone.
void remove_handle(Puppet& puppet, const std::string& id);

//! Puts every handle of a pose back to rest.
void clear_pose(Puppet& puppet, const std::string& pose);

}  // namespace puppetwarp::ui
