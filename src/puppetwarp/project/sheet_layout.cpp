#include <puppetwarp/project/sheet_layout.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace puppetwarp {

namespace {

constexpr double pleasant_ratio = 1.5;  // of a sheet's width to its height

// Space between a picture and its text, header and cells, cells and footer.
constexpr int space_px = 10;

int with_space(int height) {
    return height > 0 ? height + space_px : 0;
}

}  // namespace

SheetLayout::SheetLayout(const SheetContents& contents)
    : contents_(contents),
      column_width_(std::max(contents.picture_width, narrowest_column_px)),
      columns_(std::min(contents.columns, contents.cells)) {
    if (columns_ > 0) return;
    double best = std::numeric_limits<double>::infinity();
    int chosen = 1;
    for (columns_ = 1; columns_ <= contents.cells; ++columns_) {
        const double ratio = static_cast<double>(size().width) / size().height;
        const double empty = static_cast<double>(columns_ * rows() - contents.cells) / contents.cells;
        const double off = std::abs(std::log(ratio / pleasant_ratio)) + empty;
        if (off < best) {
            best = off;
            chosen = columns_;
        }
    }
    columns_ = chosen;
}

int SheetLayout::cell_height() const {
    return contents_.picture_height + with_space(contents_.text_height);
}

cv::Size SheetLayout::size() const {
    return {2 * margin_px + columns_ * (column_width_ + gap_px) - gap_px,
            2 * margin_px + with_space(contents_.header_height) + rows() * (cell_height() + gap_px) - gap_px +
                with_space(contents_.footer_height)};
}

cv::Rect SheetLayout::header() const {
    return {margin_px, margin_px, size().width - 2 * margin_px, contents_.header_height};
}

cv::Rect SheetLayout::footer() const {
    return {margin_px, size().height - margin_px - contents_.footer_height, size().width - 2 * margin_px,
            contents_.footer_height};
}

cv::Point SheetLayout::corner(int cell) const {
    return {margin_px + cell % columns_ * (column_width_ + gap_px),
            margin_px + with_space(contents_.header_height) + cell / columns_ * (cell_height() + gap_px)};
}

cv::Rect SheetLayout::picture(int cell) const {
    const cv::Point at = corner(cell);
    return {at.x + (column_width_ - contents_.picture_width) / 2, at.y, contents_.picture_width,
            contents_.picture_height};
}

cv::Rect SheetLayout::text(int cell) const {
    const cv::Point at = corner(cell);
    return {at.x, at.y + contents_.picture_height + space_px, column_width_, contents_.text_height};
}

}  // namespace puppetwarp
