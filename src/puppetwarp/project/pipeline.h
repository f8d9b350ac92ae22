#pragma once

#include <puppetwarp/base/image.h>
#include <puppetwarp/base/progress.h>
#include <puppetwarp/cutout/cutout.h>
#include <puppetwarp/deform/deformer.h>
#include <puppetwarp/image/read.h>
#include <puppetwarp/mesh/distortion.h>
#include <puppetwarp/mesh/outline.h>
#include <puppetwarp/mesh/triangle_mesh.h>
#include <puppetwarp/project/puppet.h>
#include <puppetwarp/warp/background.h>
#include <puppetwarp/warp/warp.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace puppetwarp {

// The way of the data, an arrow a function: what the command runs in one go and the editor runs as needed.
//   Puppet -> Image -> Cutout -> Outline -> TriangleMesh -> Deformer -> positions -> Image

//! The puppet's picture. \throw InvalidInput  none named, `read_image`, fewer than 4 pixels wide or high.
Image load_image(const Puppet& puppet, const ReadOptions& options = {});

//! Which pixels of `image` are the subject, reading the mask when there is one. \throw InvalidInput  `cut_out`.
Cutout cut_out_subject(const Puppet& puppet, const Image& image, const ReadOptions& options = {});

//! The outline of the subject; the rectangle of a whole picture.
Outline outline_subject(const Puppet& puppet, int width, int height, const Cutout& cutout);

//! Triangles over the outline, with bones and cage edges as edges; for a method that uses weights, `mesh_for_weights`.
//! \throw InvalidInput  `triangulate`.
TriangleMesh mesh_subject(const Puppet& puppet, const Outline& outline);

//! The same, with points as vertices, which weights hold. \throw InvalidInput  `triangulate`.
TriangleMesh mesh_for_weights(const Puppet& puppet, const Outline& outline);

//! Which part of image space the result shows.
struct CanvasChoice {
    enum class Kind { keep, grow, given } kind = Kind::keep;
    Canvas canvas;  //!< for `given`
};

struct RenderOptions {
    ReadOptions read;
    Interpolation interpolation = Interpolation::bicubic;
    CanvasChoice canvas;
    double pin_snap_px = 0;               //!< points at most this far outside the subject are moved onto it
    std::filesystem::path weights_cache;  //!< `weights_cache_path` of the puppet's file, or empty: weights are not kept
    std::string format;  //!< the file format the result is meant for (`output_format`), or empty: none in particular
};

//! What a run did, for reports.
struct RenderReport {
    std::string method;
    int vertices = 0;
    int triangles = 0;
    int handles = 0;
    int iterations = 0;
    bool converged = true;
    double energy = 0;
    std::vector<double> energy_history;
    Distortion distortion;
    double max_handle_error_px = 0;
    Canvas canvas;
    std::vector<std::string> warnings;                       //!< the method's, one sentence each
    std::vector<std::string> lost;                           //!< what `format` cannot hold, as phrases
    std::vector<std::pair<std::string, double>> timings_ms;  //!< stages in their order
};

//! `make_deformer`, its weights `cached_weights`.
//! \param weights_cache  see `RenderOptions`.
std::unique_ptr<Deformer> bound_deformer(const MethodOptions& method, const TriangleMesh& mesh, const Rig& rig,
                                         const std::filesystem::path& weights_cache, Progress& progress);

//! Fills in what a report says of a deformation: method, sizes, convergence, distortion.
//! \throw InvalidInput  a position is not finite: the mesh is too bad to compute with.
void describe(const MethodOptions& method, const TriangleMesh& mesh, const Rig& rig, const Deformation& deformation,
              RenderReport& report);

struct Rendered {
    Image image;
    TriangleMesh mesh;
    Eigen::MatrixX2d moved;  //!< #V x 2
    Eigen::VectorXd depth;   //!< `vertex_depths` of the pose
    Rig rig;                 //!< as it took hold: points that were snapped onto the subject lie there
    RenderReport report;
};

//! The whole way from a puppet in a pose to a picture.
//! \throw InvalidInput  no handles at all, and as each stage.   \throw Cancelled
Rendered render(const Puppet& puppet, const Pose& pose, const RenderOptions& options, Progress& progress);

//! The subject alone, as it is warped: `apply_cutout`, its edges clean of what was behind it (`with_clean_edges`) but
//! for the background `keep`, which shows what was behind: there the rest pose is the picture again.
Image cut_subject(const Image& image, const Cutout& cutout, const Background& background);

//! The last arrows alone, for positions that are known already: warp, then background, then what `options.format` asks
//! for. Fills `canvas` and `lost` of the report.
//! \param depth  `vertex_depths` of the pose.
Image draw_subject(const Puppet& puppet, const Image& image, const Cutout& cutout, const TriangleMesh& mesh,
                   const Eigen::MatrixX2d& moved, const Eigen::VectorXd& depth, const RenderOptions& options,
                   RenderReport& report, Progress& progress);

}  // namespace puppetwarp
