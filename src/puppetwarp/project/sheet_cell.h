#pragma once
// Private header: what stands in one cell of a sheet.

#include <puppetwarp/base/picture_text.h>
#include <puppetwarp/project/method_sheet.h>

#include <opencv2/core/mat.hpp>

namespace puppetwarp {

//! What the cells of a sheet have in common. Keeps references to what it is made from.
class CellPainter {
public:
    //! \param subject  the picture, cut out.   \param width, height  of a cell's picture, px.
    CellPainter(const Image& subject, const TriangleMesh& mesh, const Rig& rig, const Canvas& canvas, int width,
                int height);

    //! The subject with its vertices at `moved` and its handles where `pose` puts them. 8-bit RGB.
    cv::Mat warped(const Eigen::MatrixX2d& moved, const Pose& pose, Progress& progress) const;
    //! Its triangles in the colours of their distortion, with the same handles.
    cv::Mat distortion(const Eigen::MatrixX2d& moved, const Pose& pose) const;

private:
    cv::Mat ground() const;
    cv::Mat finished(Image& drawn, const Pose& pose) const;

    const Image& subject_;
    const TriangleMesh& mesh_;
    const Rig& rig_;
    Canvas canvas_;
    int width_;
    int height_;
    double scale_;  //!< large pixels, those that are averaged, for one of image space
};

//! Lines below the pictures, at most.
int cell_text_height(bool timings);

//! Writes a method's name, folds, largest stretch, energy and, when asked for, times below its picture.
void write_result(cv::Mat& sheet, const MethodResult& result, bool timings, const cv::Rect& place);

//! Writes a title and plain lines below a picture.
void write_lines(cv::Mat& sheet, const std::string& title, const std::vector<std::string>& lines,
                 const cv::Rect& place);

//! Fills the place of a picture with the reason why there is none.
void write_error(cv::Mat& sheet, const std::string& error, const cv::Rect& place);

}  // namespace puppetwarp
