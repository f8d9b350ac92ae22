#pragma once

#include <puppetwarp/base/image.h>
#include <puppetwarp/warp/batch.h>
#include <puppetwarp/warp/face_map.h>
#include <puppetwarp/warp/footprint.h>
#include <puppetwarp/warp/spans.h>

namespace puppetwarp::detail {

//! `warp` with the instruction set chosen: all give the same bytes, and tests check that.
Image warp_with(Simd simd, const Image& image, const TriangleMesh& rest, const Eigen::MatrixX2d& moved,
                const WarpOptions& options, Progress& progress);

//! Paints the triangles of a mesh, band by band. Keeps references to what it is made from.
class Painter {
public:
    //! \param pixels  the source; \param out the canvas' pixels: allocated, of the format's output type.
    Painter(const cv::Mat& pixels, const PixelFormat& format, const TriangleMesh& rest, const Eigen::MatrixX2d& moved,
            const SnappedMesh& spans, const WarpOptions& options, Simd simd, cv::Mat& out);

    //! Paints rows of the canvas. Different bands may be painted by different threads at a time.
    void paint(RowRange band) const;

private:
    struct Part;
    struct Plan;
    Plan planned(RowRange band) const;
    void add_spans(int triangle, RowRange band, Plan& plan) const;
    Part part_of(int triangle) const;
    void clear(RowRange rows) const;
    void paint_strip(const Plan& plan, std::size_t strip, Batch& batch) const;
    void paint_span(const Part& part, const Span& span, Batch& batch) const;
    void copy_span(const Part& part, const Span& span, Batch& batch) const;
    void sample_span(const Part& part, const Span& span, Batch& batch) const;
    void supersample_span(const Part& part, const Span& span, Batch& batch) const;
    std::ptrdiff_t bytes_ahead(const FaceMap& map) const;
    double centre_x(int column) const { return static_cast<double>(canvas_.x) + column + 0.5; }
    double centre_y(int row) const { return static_cast<double>(canvas_.y) + row + 0.5; }

    PixelFormat format_;
    const TriangleMesh& rest_;
    const Eigen::MatrixX2d& moved_;
    const SnappedMesh& spans_;
    Canvas canvas_;
    Interpolation interpolation_;
    Samplers samplers_;
    SampledView single_;
    SampledView several_;
    PixelOps ops_;
    cv::Mat& out_;
};

}  // namespace puppetwarp::detail
