#pragma once

#include <puppetwarp/base/image.h>
#include <puppetwarp/base/progress.h>
#include <puppetwarp/project/pipeline.h>
#include <puppetwarp/project/puppet.h>

#include <string>
#include <utility>
#include <vector>

namespace puppetwarp {

//! One way to bend a subject, by its name on a sheet.
struct LabelledMethod {
    std::string label;
    MethodOptions options;
};

//! Every method of `method_names()` by its name, and `arap` with its other energies as `arap (ENERGY)`.
//! \param options  of all of them, but for method and energy.
std::vector<LabelledMethod> labelled_methods(const MethodOptions& options = {});

struct MethodSheetOptions {
    //! What the cells of the methods show: the warped picture, or each triangle in the colour of its distortion.
    enum class Show { picture, distortion } show = Show::picture;

    ReadOptions read;
    double pin_snap_px = 0;            //!< points at most this far outside the subject are moved onto it
    std::vector<std::string> methods;  //!< labels, in the order of the sheet; empty: all
    int columns = 0;                   //!< at most 64; 0: as many as make a sheet of about 3 to 2
    int cell_px = 320;                 //!< longer side of each picture, 120 to 2000
    bool timings = false;              //!< also on the sheet, which then differs from run to run
};

//! What one method made of the pose.
struct MethodResult {
    std::string label;
    std::string error;       //!< why it could not take the pose, or empty
    RenderReport report;     //!< without an error: as of `describe`, with the times of `bind` and `deform`
    Eigen::MatrixX2d moved;  //!< without an error: #V x 2
    bool cut_off = false;    //!< runs so far away from what most methods do that its cell does not hold it
};

struct MethodSheet {
    Image image;  //!< 8-bit RGB, with the colour profile of the puppet's picture where it is of RGB
    std::vector<MethodResult> methods;
    std::string pose;
    TriangleMesh mesh;  //!< what all of them moved
    Rig rig;            //!< as it took hold
    Canvas canvas;      //!< the part of image space that each cell shows
    int columns = 0;
    int rows = 0;
    std::vector<std::pair<std::string, double>> timings_ms;  //!< stages in their order; `compare` is all methods
};

//! A sheet of the same pose of the same mesh through many methods, to be compared by eye and number. The first cell
//! is the rest pose with its handles. All show the same part of image space, which holds the subject at rest and as
//! each method moves it (but for one that runs away, `cut_off`), over a chequered ground; handles are drawn where the
//! pose puts them. Below each stand its folds, largest stretch and energy. A method that cannot take the pose says why
//! in its cell. Without `timings` the same bytes each time, for any number of threads. \throw InvalidInput  options out
//! of range, unknown labels (lists the known ones), no handles; what `load_image` to
//!        `mesh_subject` refuse; what the first method says, when none can take the pose.   \throw Cancelled
MethodSheet compare_methods(const Puppet& puppet, const Pose& pose, const MethodSheetOptions& options,
                            Progress& progress);

}  // namespace puppetwarp
