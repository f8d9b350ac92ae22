#pragma once

#include <puppetwarp/base/image.h>
#include <puppetwarp/cutout/cutout.h>
#include <puppetwarp/mesh/distortion.h>
#include <puppetwarp/mesh/triangle_mesh.h>
#include <puppetwarp/project/puppet.h>

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace puppetwarp::ui {

//! A picture and its subject, and both made ready to be shown.
struct Subject {
    Image image;
    Cutout cutout;
    //! #rows x #cols of CV_8UC4, RGB premultiplied by alpha, no side longer than the screen's memory takes.
    cv::Mat shown_subject;
    //! The picture before the cutout, likewise; for backgrounds that keep it.
    cv::Mat shown_picture;
    //! The picture filled where its subject was (`fill_behind`), likewise; empty while no background asks for it.
    cv::Mat shown_filled;
};

//! What the screen shall show: a puppet in a pose.
struct ShapeRequest {
    std::uint64_t revision = 0;
    std::shared_ptr<const Puppet> puppet;
    Pose pose;
    //! While a pin is dragged: go on from the last positions for as long as a frame takes. Else what the command
    //! renders.
    bool live = false;
    //! After a drag, or when handles came or went: go on from the last positions to the end, and take from there into
    //! the pose how far its points turned. Then what the command renders of that pose.
    bool keep_way = false;
};

//! What the screen shows: a puppet in a pose, as far as it could be made.
struct Shape {
    std::uint64_t revision = 0;                //!< of the request this answers
    std::shared_ptr<const Subject> subject;    //!< null: there is no picture
    std::shared_ptr<const TriangleMesh> mesh;  //!< null: there are no triangles
    Eigen::MatrixX2d moved;                    //!< #V x 2 positions of the mesh
    Eigen::VectorXi order;                     //!< `painters_order` of the pose; empty: the order of the triangles
    Distortion distortion;
    bool live = false;      //!< of the request
    bool converged = true;  //!< the method came to its end (a live shape need not)
    bool more = false;      //!< a live shape that the same request, made again, brings nearer to the end
    double deform_ms = 0;   //!< what the deformation took
    //! By handle id, how far points with a free angle have turned on their way, whole turns counted, radians: what
    //! `with_turns` puts into the pose. Of requests that are live or keep the way; empty where a method follows none.
    std::map<std::string, double> turns;
    double jump_px = 0;                 //!< of a request that keeps the way: how far the file's shape is from the last
    std::vector<std::string> warnings;  //!< what a person should know of, a phrase each
    std::string error;                  //!< why the way ended before its end, one line; empty: it did not
};

}  // namespace puppetwarp::ui
