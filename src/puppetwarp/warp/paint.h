#pragma once

#include <puppetwarp/base/image.h>
#include <puppetwarp/warp/batch.h>
#include <puppetwarp/warp/border.h>
#include <puppetwarp/warp/face_map.h>
#include <puppetwarp/warp/footprint.h>
#include <puppetwarp/warp/pyramid.h>
#include <puppetwarp/warp/spans.h>

namespace puppetwarp::detail {

//! What is painted with.
struct Paint {
    const cv::Mat& pixels;  //!< the source
    PixelFormat format;
    const LightTables* light;  //!< for linear light, or null
};

//! Where a moved mesh lies on the canvas.
struct Layout {
    const SnappedMesh& mesh;
    const BorderPixels& border;
    bool one_layer;  //!< whether each pixel of the canvas is held by one triangle, for certain
};

//! Paints the triangles of a mesh, band by band. Keeps references to what it is made from.
class Painter {
public:
    Painter(const Paint& paint, const TriangleMesh& rest, const Eigen::MatrixX2d& moved, const Layout& layout,
            const WarpOptions& options, Simd simd);

    //! Paints rows of the canvas. Different bands may be painted by different threads at a time.
    //! \param out  of the format's output type, holds these rows.
    void paint(RowRange band, const CanvasRows& out) const;

private:
    struct Part;
    struct Strip;
    struct Plan;
    Plan planned(RowRange band) const;
    Part part_of(int triangle) const;
    void add_triangle(int triangle, Plan& plan) const;
    void add_span(const Part& part, int row, int first, int last, Plan& plan) const;
    void add_border(const BorderPixel& pixel, Plan& plan) const;
    void clear(const Strip& strip, const CanvasRows& out) const;
    void paint_strip(const Plan& plan, const Strip& strip, Batch& batch) const;
    void paint_span(const Plan& plan, const Span& span, Batch& batch) const;
    const SampledView& view_of(const Footprint& shape) const;
    void sample(const Part& part, double x, double y, const Batch::Target& target, Batch& batch) const;
    Eigen::Vector2d sampled_centre(const BorderPixel& pixel) const;
    void find_levels(Simd simd);
    std::ptrdiff_t bytes_ahead(const FaceMap& map) const;
    double centre_x(int column) const { return static_cast<double>(canvas_.x) + column + 0.5; }
    double centre_y(int row) const { return static_cast<double>(canvas_.y) + row + 0.5; }

    PixelFormat format_;
    const TriangleMesh& rest_;
    const Eigen::MatrixX2d& moved_;
    const SnappedMesh& mesh_;
    const BorderPixels& border_;
    bool counts_layers_;
    Canvas canvas_;
    Interpolation interpolation_;
    Samplers samplers_;
    SampledView single_;
    SampledView several_;
    Pyramid pyramid_;
    std::vector<SampledView> levels_;
    PixelOps ops_;
};

}  // namespace puppetwarp::detail
