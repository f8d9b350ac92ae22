#pragma once

#include <puppetwarp/base/image.h>
#include <puppetwarp/base/progress.h>
#include <puppetwarp/cutout/cutout.h>
#include <puppetwarp/deform/deformer.h>
#include <puppetwarp/image/picture_rows.h>
#include <puppetwarp/image/read.h>
#include <puppetwarp/mesh/distortion.h>
#include <puppetwarp/mesh/outline.h>
#include <puppetwarp/mesh/triangle_mesh.h>
#include <puppetwarp/project/puppet.h>
#include <puppetwarp/warp/background.h>
#include <puppetwarp/warp/warp.h>

#include <filesystem>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace puppetwarp {

// The way of the data, an arrow a function: what the command runs in one go and the editor runs as needed.
//   Puppet -> Image -> Cutout -> Outline -> TriangleMesh -> Deformer -> positions -> Image

//! The puppet's picture. \throw InvalidInput  none named, `read_image`, fewer than 4 pixels wide or high.
Image load_image(const Puppet& puppet, const ReadOptions& options = {});

//! A picture to be warped, from a file. \throw InvalidInput  as above.
Image load_image(const std::filesystem::path& path, const ReadOptions& options = {});

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
    enum class Kind {
        keep,  //!< the picture's own
        grow,  //!< that and all that was moved
        given,
        of_map  //!< all that a displacement map holds; only with one
    } kind = Kind::keep;
    Canvas canvas;  //!< for `given`: in image space, before any scale
};

struct RenderOptions {
    ReadOptions read;
    //! Drawn instead of the puppet's own picture, or empty. It may have another resolution: image space, in which all
    //! coordinates are, stays that of the puppet's own, whose header tells its size.
    std::filesystem::path image;
    double scale = 1;  //!< pixels of the result along each axis for one of the picture that is drawn, above 0
    Interpolation interpolation = Interpolation::bicubic;
    bool linear = false;  //!< see `WarpOptions`
    CanvasChoice canvas;
    int automatic_cage = 0;               //!< corners of a cage that is put around the subject; 0: none
    double pin_snap_px = 0;               //!< points at most this far outside the subject are moved onto it
    std::filesystem::path weights_cache;  //!< `weights_cache_path` of the puppet's file, or empty: weights are not kept
    std::string format;    //!< the file format the result is meant for (`output_format`), or empty: none in particular
    bool in_rows = false;  //!< fill `Rendered::rows` instead of `Rendered::image`
    bool keep_source = false;  //!< fill `Rendered::source` and `matte`
};

//! What a run did, for reports.
struct RenderReport {
    std::string
        method;  //!< empty: nothing was deformed, and only canvas, scale, lost, warnings and timings say anything
    int vertices = 0;
    int triangles = 0;
    int handles = 0;
    int iterations = 0;
    bool converged = true;
    double energy = 0;
    std::vector<double> energy_history;
    Distortion distortion;
    double max_handle_error_px = 0;
    Canvas canvas;     //!< pixels of the result
    double scale = 1;  //!< pixels of the result for one of image space
    //! Pixels of the result for one of the picture, at most: `largest_magnification`. 0: unknown.
    double max_magnification = 0;
    std::vector<std::string> warnings;                       //!< the method's, one sentence each
    std::vector<std::string> lost;                           //!< what `format` cannot hold, as phrases
    std::vector<std::pair<std::string, double>> timings_ms;  //!< stages in their order
};

//! `make_deformer`, its weights `cached_weights`.
//! \param weights_cache  see `RenderOptions`.
std::unique_ptr<Deformer> bound_deformer(const MethodOptions& method, const TriangleMesh& mesh, const Rig& rig,
                                         const std::filesystem::path& weights_cache, Progress& progress);

//! Fills in what a report says of a deformation: method, sizes, convergence, distortion, targets not reached.
//! \throw InvalidInput  a position is not finite: the mesh is too bad to compute with.
void describe(const MethodOptions& method, const TriangleMesh& mesh, const Rig& rig, const Pose& pose,
              const Deformation& deformation, RenderReport& report);

struct Rendered {
    Image image;
    //! With `in_rows`: what is drawn while it is written, with the progress that `render` was given.
    PictureRows rows;
    std::shared_ptr<const double> rows_ms;  //!< with `in_rows`: the time that making rows has taken until now
    Image source;                           //!< what the mesh was filled from, with `keep_source`: the cut-out picture
    cv::Mat matte;                          //!< of a cutout that is not the picture's own alpha, with `keep_source`
    TriangleMesh mesh;                      //!< in image space
    Eigen::MatrixX2d moved;                 //!< #V x 2, in image space
    Eigen::VectorXd depth;                  //!< `vertex_depths` of the pose
    BackFaces back_faces = BackFaces::hide;
    Eigen::RowVector2d resolution{1, 1};  //!< pixels of `source` for one of image space, along x and y
    double scale = 1;                     //!< pixels of `image` for one of `source`
    //! As it took hold: points that were snapped onto the subject lie there, and an automatic cage comes last.
    Rig rig;
    RenderReport report;
};

//! The whole way from a puppet in a pose to a picture.
//! \throw InvalidInput  no handles at all, and as each stage.   \throw Cancelled
Rendered render(const Puppet& puppet, const Pose& pose, const RenderOptions& options, Progress& progress);

//! A picture drawn through a displacement map from a file (`read_displacement`, `warp_through`) instead of a mesh: at
//! the map's resolution, or where the map knows its source's size, as many times that as the picture is larger; times
//! `options.scale`. Of the options those of the puppet are passed over; a given canvas counts pixels of the picture.
//! \param background  as a puppet file has it.
//! \return  without mesh and rig, the report without method.
//! \throw InvalidInput  as those functions; a map made for a picture of another shape; a canvas over the limit.
Rendered render_through(const std::filesystem::path& picture, const std::filesystem::path& map,
                        const std::string& background, const RenderOptions& options, Progress& progress);

//! The subject alone, as it is warped: `apply_clean_cutout`, but `apply_cutout` for the background `keep`, which shows
//! what was behind: there the rest pose is the picture again.
Image cut_subject(const Image& image, const Cutout& cutout, const Background& background);

//! `draw_subject` below, as rows that are drawn as they are asked for where nothing asks for all of them before. They
//! share the pixels of `image`. \param progress  must live as long as they are asked for.
PictureRows draw_subject_rows(const Puppet& puppet, Image image, const Cutout& cutout, const TriangleMesh& mesh,
                              const Eigen::MatrixX2d& moved, const Eigen::VectorXd& depth, const RenderOptions& options,
                              RenderReport& report, Progress& progress);

//! The last arrows alone, for positions that are known already: warp, then background, then what `options.format` asks
//! for. Fills `canvas`, `scale`, `max_magnification` and `lost` of the report. Mesh, positions and a given canvas are
//! in pixels of `image`.
//! \param depth  `vertex_depths` of the pose.
Image draw_subject(const Puppet& puppet, const Image& image, const Cutout& cutout, const TriangleMesh& mesh,
                   const Eigen::MatrixX2d& moved, const Eigen::VectorXd& depth, const RenderOptions& options,
                   RenderReport& report, Progress& progress);

}  // namespace puppetwarp
