#pragma once

#include <puppetwarp/base/point.h>

#include <opencv2/core/mat.hpp>

#include <cstdint>
#include <span>
#include <vector>

namespace puppetwarp {

//! Reads a matte of any depth as one kind of number; outside the picture there is no coverage.
class MatteReader {
public:
    static constexpr int full = 4080;  //!< full coverage; 16 of them fit in 16 bits

    //! \param matte  one channel, CV_8U, CV_16U or CV_32F; shared, not copied.
    explicit MatteReader(const cv::Mat& matte) : matte_(matte) {}

    //! A part of the matte as a matte of its own.
    MatteReader window(const cv::Rect& part) const { return MatteReader(matte_(part)); }

    int columns() const { return matte_.cols; }
    int rows() const { return matte_.rows; }
    //! Coverage of the pixels (first, j), (first + 1, j), ..., inside the picture or not, in units of 1 / full.
    void coverage_span(int j, int first, std::span<std::uint16_t> out) const;
    //! 255 where there is any coverage, else 0. \pre the pixels are inside the picture.
    void support_span(int j, int first, std::span<std::uint8_t> out) const;
    //! What the pixels first <= i < last of row `j` have in common, the picture's outside being uncovered.
    enum class Uniform { uncovered, full, no };
    Uniform uniform(int j, int first, int last) const;
    int coverage(int i, int j) const;
    bool covered(int i, int j) const;

    //! The smallest rectangle of pixels that holds all coverage; empty when there is none.
    cv::Rect support_box() const;

private:
    bool within(int i, int j) const { return i >= 0 && j >= 0 && i < matte_.cols && j < matte_.rows; }
    cv::Mat matte_;
};

enum class SilhouetteLevel {
    half,    //!< where coverage is at least half: what the eye takes for the subject's edge
    support  //!< where there is any coverage
};

//! The smooth outline of a matte at one level, sub-pixel where the matte is antialiased and free of stairs where it
//! is hard; outer boundaries have positive area. The polygons may touch or, rarely, cross each other slightly:
//! they are meant to be offset.
//! Marching squares on lightly blurred coverage; each contour is then pulled taut through the grid edges it crosses,
//! which finds the straight pieces, and lines fitted to these place them (after Selinger 2003, "Potrace").
std::vector<Polyline> trace_silhouette(const MatteReader& matte, SilhouetteLevel level);

}  // namespace puppetwarp
