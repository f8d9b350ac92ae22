#pragma once

#include <puppetwarp/base/image.h>
#include <puppetwarp/base/point.h>
#include <puppetwarp/base/progress.h>
#include <puppetwarp/mesh/triangle_mesh.h>
#include <puppetwarp/warp/warp.h>

#include <memory>

namespace puppetwarp {

//! Where the pixels of a displacement map lie.
struct DisplacementPlane {
    Canvas canvas;         //!< of the output, in pixels of the output
    double scale = 1;      //!< pixels of the output for one of the source
    int source_width = 0;  //!< of the picture whose places the map tells
    int source_height = 0;

    //! The place of a pixel's centre before any displacement, in pixels of the source.
    Point place(int column, int row) const {
        return {(static_cast<double>(canvas.x) + column + 0.5) / scale,
                (static_cast<double>(canvas.y) + row + 0.5) / scale};
    }
};

//! A warp as numbers: which place of the source each pixel of the output shows.
struct DisplacementMap {
    DisplacementPlane plane;
    //! #rows x #cols, CV_32FC3: the place that a pixel's centre shows less its own (`plane.place`), in pixels of the
    //! source, x right, y down, not numbers where nothing is shown; then how much of what the source has there is
    //! shown, in [0, 1].
    cv::Mat displacement;
    double rounding_px = 0;  //!< how far places may be off by the numbers of a file that the map was read from
};

//! The map that `warp` draws with, made row by row: for maps that are too large to be held at once.
//!
//! A pixel's place is that of the triangle which `warp` draws there: whole displacements where triangles are copied,
//! else rounded to 32-bit floats, so off by at most 2^-24 of the displacement's length (2e-5 px for 300 px).
//! Where triangles lie over each other it is the one that contributes most to the pixel by the picture's alpha, the
//! foremost of equals: a map has one layer, and soft edges before something else become hard.
//! What is shown is 1 where there is a triangle, and less only where a cutout that is not the picture's own alpha takes
//! something away: then it is what is left of all layers.
class DisplacementRows {
public:
    //! \param image  the source, cut out as it is drawn; only its alpha is looked at. Shared.
    //! \param matte  what the cutout left, where that is not in the alpha of the picture that the map will be used on:
    //!        #rows x #cols as `Cutout::matte`; else empty.
    //! \param moved  #V x 2 positions in pixels of the output.
    //! \param scale  pixels of the output for one of the source; only says what displacements are relative to.
    //! \throw InvalidInput, MachineFault  as `warp`.
    DisplacementRows(const Image& image, const cv::Mat& matte, const TriangleMesh& rest, const Eigen::MatrixX2d& moved,
                     const WarpOptions& options = {}, double scale = 1);
    ~DisplacementRows();
    DisplacementRows(DisplacementRows&&) noexcept;
    DisplacementRows& operator=(DisplacementRows&&) noexcept;

    const DisplacementPlane& plane() const;

    //! Rows from `first_row` on. The same for any number of threads and any division into calls.
    //! \param rows  #rows x canvas.width, CV_32FC3: filled as `DisplacementMap::displacement`.
    void fill(int first_row, cv::Mat& rows) const;

private:
    struct Drawn;
    std::unique_ptr<Drawn> drawn_;
};

//! All rows of `DisplacementRows`, without a matte. \throw InvalidInput, MachineFault  as `warp`.
DisplacementMap displacement_map(const Image& image, const TriangleMesh& rest, const Eigen::MatrixX2d& moved,
                                 const WarpOptions& options = {}, double scale = 1);

struct ThroughMapOptions {
    Interpolation interpolation = Interpolation::bicubic;
    double x_magnification = 1;  //!< pixels of the output for one of the map, above 0
    double y_magnification = 1;
    Canvas canvas;        //!< in pixels of the output; of no size: all that the map holds
    bool linear = false;  //!< as in `WarpOptions`
};

//! Draws a picture through a displacement map: `warp`, with the places read instead of computed.
//!
//! Places are taken as shares of the source's size, so that a map made on another resolution of the picture serves too.
//! Sampling is that of `warp`; where the map, judged by its neighbouring pixels, shrinks by more than 1.5, a pixel is
//! the mean of several samples, as there. Places more than half a pixel outside of the picture show nothing, nor do
//! pixels beyond the map. At a magnification other than 1 the map is interpolated bilinearly, but not across tears,
//! where one part lies over another: there each side goes on along its own slope. What `displacement_map` gives of a
//! whole-pixel move copies pixels; away from edges of triangles, 8-bit pictures come out within one level of `warp`.
//! \throw InvalidInput  a map of no size, a canvas as for `warp`.   \throw MachineFault, Cancelled  as `warp`.
Image warp_through(const Image& image, const DisplacementMap& map, const ThroughMapOptions& options,
                   Progress& progress);
Image warp_through(const Image& image, const DisplacementMap& map, const ThroughMapOptions& options = {});

}  // namespace puppetwarp
