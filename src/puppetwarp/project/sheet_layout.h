#pragma once
// Private header: where things are on a sheet of equal cells.

#include <puppetwarp/warp/warp.h>

#include <opencv2/core/types.hpp>

#include <vector>

namespace puppetwarp {

//! The part of image space that all cells of a sheet show: the subject at rest and as each method moves it, with a
//! margin for the marks of handles. A method that runs away from what most make of the pose, by more than a quarter of
//! that size, is not made room for: it would make all others too small to be seen.
//! \param rest   #V x 2, not empty.
//! \param moved  finite positions of each method, #V x 2 each.
Canvas common_view(const Eigen::MatrixX2d& rest, const std::vector<Eigen::MatrixX2d>& moved);

//! Whether some position is not on the canvas.
bool runs_out_of(const Canvas& canvas, const Eigen::MatrixX2d& positions);

//! What the cells of a sheet hold, px.
struct SheetContents {
    int cells = 1;
    int columns = 0;  //!< 0: as many as make the sheet about 3 wide for 2 high with few empty places
    int picture_width = 0;
    int picture_height = 0;
    int text_height = 0;    //!< below each picture
    int header_height = 0;  //!< above all cells
    int footer_height = 0;  //!< below all cells
};

//! Cells in rows, from left to right and from above, with their pictures centred in columns that are wide enough for
//! text also where pictures are narrow.
class SheetLayout {
public:
    static constexpr int margin_px = 20;             //!< around the sheet
    static constexpr int gap_px = 24;                //!< between cells
    static constexpr int narrowest_column_px = 216;  //!< room for the words below a picture

    //! \pre cells at least 1, pictures of some size.
    explicit SheetLayout(const SheetContents& contents);

    int columns() const { return columns_; }
    int rows() const { return (contents_.cells + columns_ - 1) / columns_; }
    cv::Size size() const;
    cv::Rect header() const;
    cv::Rect footer() const;
    cv::Rect picture(int cell) const;
    cv::Rect text(int cell) const;

private:
    cv::Point corner(int cell) const;
    int cell_height() const;

    SheetContents contents_;
    int column_width_;
    int columns_;
};

}  // namespace puppetwarp
