#pragma once

#include <puppetwarp/base/image.h>
#include <puppetwarp/base/progress.h>
#include <puppetwarp/mesh/triangle_mesh.h>
#include <puppetwarp/warp/border.h>
#include <puppetwarp/warp/light.h>
#include <puppetwarp/warp/paint.h>
#include <puppetwarp/warp/spans.h>
#include <puppetwarp/warp/warp.h>
#include <puppetwarp/warp/warp_input.h>

#include <optional>
#include <vector>

namespace puppetwarp::detail {

//! All that one warp needs before its first pixel.
class WarpJob {
public:
    //! \param simd  all give the same bytes, and tests check that.
    //! \throw InvalidInput  as `warp`.
    WarpJob(Simd simd, const Image& image, const TriangleMesh& rest, const Eigen::MatrixX2d& moved,
            const WarpOptions& options);
    WarpJob(const WarpJob&) = delete;
    WarpJob& operator=(const WarpJob&) = delete;

    const Canvas& canvas() const { return options_.canvas; }
    //! Type of the result's pixels.
    int type() const { return CV_MAKETYPE(format_.depth, format_.out_channels()); }
    //! As in `WarpedRows`.
    std::optional<bool> covered() const;

    //! Rows [first, last) of the canvas. \throw MachineFault  not enough memory.
    cv::Mat rows(int first, int last, Progress& progress) const;

private:
    Image image_;
    WarpInput input_;
    WarpOptions options_;
    SnappedMesh spans_;
    std::vector<BorderEdge> edges_;
    BorderPixels border_;
    int layers_;  // triangles that hold each pixel, where that is the same for all; else -1
    bool centres_covered_;
    PixelFormat format_;
    std::optional<LightTables> light_;
    Painter painter_;
};

//! `warp` with the instruction set chosen.
Image warp_with(Simd simd, const Image& image, const TriangleMesh& rest, const Eigen::MatrixX2d& moved,
                const WarpOptions& options, Progress& progress);

}  // namespace puppetwarp::detail
