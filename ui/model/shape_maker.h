#pragma once

#include "model/shape.h"

#include <puppetwarp/base/progress.h>
#include <puppetwarp/deform/deformer.h>

#include <memory>
#include <string>

namespace puppetwarp::ui {

//! The library's pipeline, run as far as something has changed since the last time.
//! What it keeps belongs to one thread.
class ShapeMaker {
public:
    //! \param longest_side_px  how large a picture the screen's memory takes.
    explicit ShapeMaker(int longest_side_px) : longest_side_px_(longest_side_px) {}

    //! Never throws what the library refuses: that is `Shape::error`, beside all that could be made.
    //! \throw Cancelled
    std::shared_ptr<const Shape> make(const ShapeRequest& request, Progress& progress);

private:
    // A method made ready, and what it was made for.
    struct Prepared {
        std::string key;
        std::unique_ptr<const Deformer> deformer;
    };

    void update_subject(const Puppet& puppet, Progress& progress);
    void update_mesh(const Puppet& puppet, Progress& progress);
    Rig rig(const Puppet& puppet);
    const Deformer& prepared(const Puppet& puppet, bool live, Progress& progress);
    void deform(const ShapeRequest& request, Shape& shape, Progress& progress);

    int longest_side_px_;
    std::string subject_key_;
    std::shared_ptr<const Subject> subject_;
    std::string mesh_key_;
    std::shared_ptr<const TriangleMesh> mesh_;
    std::string stiffness_key_;
    std::vector<Stiffness> stiffness_;  // of subject_, pictures loaded
    Prepared exact_;
    Prepared live_;
    Eigen::MatrixX2d last_moved_;  // of mesh_; where live deformations begin
};

}  // namespace puppetwarp::ui
