#pragma once

#include <puppetwarp/base/point.h>
#include <puppetwarp/deform/deformer.h>
#include <puppetwarp/rig/rig.h>
#include <puppetwarp/warp/warp.h>

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace puppetwarp {

//! How a puppet file says which pixels are the subject.
struct CutoutSettings {
    std::string from = "auto";    //!< auto, alpha, mask, polygon, whole
    std::string path;             //!< of the mask, relative to the puppet file
    Polyline points;              //!< of the polygon, image pixels
    std::vector<Polyline> holes;  //!< of the polygon
};

//! How a puppet file asks for triangles. What is not set is chosen from the subject's size.
struct MeshSettings {
    std::optional<double> max_edge_px;    //!< above 0
    std::optional<double> min_angle_deg;  //!< 0 to 30
    std::optional<double> expand_px;      //!< at least 0
};

//! Everything that a person chose, and nothing that can be computed: the puppet file (version 1).
//! A plain value; copies are cheap enough for undo.
struct Puppet {
    std::filesystem::path folder;  //!< relative paths below are relative to it; empty: the working folder
    std::string image;             //!< path of the picture; empty: none
    CutoutSettings cutout;
    std::optional<std::string> background;  //!< `background_from_name`; none: transparent
    BackFaces back_faces = BackFaces::hide;
    MeshSettings mesh;
    Rig rig;
    MethodOptions method;
    std::vector<Pose> poses;
    //! The JSON text this was read from, or empty: `to_json` takes keys from it that this version does not know.
    std::string source;
};

//! Reads a puppet file. \throw InvalidInput  unreadable, not JSON (says where), another format or version, a field of
//! a wrong type or out of range (names the field).
Puppet read_puppet(const std::filesystem::path& path);

//! As `read_puppet`, from text. \param subject  how errors name the document.
Puppet parse_puppet(std::string_view text, const std::string& subject, const std::filesystem::path& folder = {});

//! The document as indented JSON in a stable key order, unknown keys of `puppet.source` kept.
std::string to_json(const Puppet& puppet);

//! Writes the document, whole or not at all; relative paths are rewritten to be relative to the new folder.
//! \throw InvalidInput  missing or read-only folder.  \throw MachineFault  disk full.
void write_puppet(const Puppet& puppet, const std::filesystem::path& path);

//! A path of the puppet, seen from the working folder.
std::filesystem::path resolve(const Puppet& puppet, const std::string& path);

//! The pose of this name; `rest` is always there. \throw InvalidInput  no such pose (lists the names).
Pose find_pose(const Puppet& puppet, const std::string& name);

//! The pose that is meant when none is named: the first one, or rest when there is none.
Pose default_pose(const Puppet& puppet);

}  // namespace puppetwarp
