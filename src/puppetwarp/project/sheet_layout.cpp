#include <puppetwarp/project/sheet_layout.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace puppetwarp {

namespace {

constexpr double view_margin = 0.03;  // around the view, as a share of its size
constexpr double runaway = 0.25;      // how far one method may enlarge the view that suits most, as a share of its size

// The bounding box of positions, all of whose sides grow outwards: left, top, right and bottom, the first two negated.
using Sides = Eigen::Array4d;

Sides sides_of(const Eigen::MatrixX2d& positions) {
    Sides sides;
    sides << -positions.colwise().minCoeff().transpose(), positions.colwise().maxCoeff().transpose();
    return sides;
}

double size_of(const Sides& sides) {
    return (sides.head<2>() + sides.tail<2>()).matrix().norm();
}

// For each side the middle one of all, towards the inside where there are two.
Sides median(const std::vector<Sides>& all) {
    Sides result;
    for (int side = 0; side < 4; ++side) {
        std::vector<double> values;
        values.reserve(all.size());
        for (const Sides& each : all) values.push_back(each[side]);
        const auto middle = values.begin() + (static_cast<std::ptrdiff_t>(values.size()) - 1) / 2;
        std::nth_element(values.begin(), middle, values.end());
        result[side] = *middle;
    }
    return result;
}

constexpr double pleasant_ratio = 1.5;  // of a sheet's width to its height

// Space between a picture and its text, header and cells, cells and footer.
constexpr int space_px = 10;

int with_space(int height) {
    return height > 0 ? height + space_px : 0;
}

}  // namespace

Canvas common_view(const Eigen::MatrixX2d& rest, const std::vector<Eigen::MatrixX2d>& moved) {
    Sides view = sides_of(rest);
    std::vector<Sides> all;
    all.reserve(moved.size());
    for (const Eigen::MatrixX2d& each : moved) all.push_back(sides_of(each));
    if (!all.empty()) view = view.max(median(all));
    const Sides limit = view + runaway * size_of(view);
    for (const Sides& each : all) view = (each > limit).select(view, view.max(each));
    view = (view + view_margin * size_of(view)).ceil();
    constexpr double farthest = 1 << 30;  // no canvas reaches farther
    const Eigen::Array4i whole = view.max(-farthest).min(farthest - 1).cast<int>();
    return {-whole[0], -whole[1], whole[0] + whole[2], whole[1] + whole[3]};
}

bool runs_out_of(const Canvas& canvas, const Eigen::MatrixX2d& positions) {
    Sides sides;
    sides << -canvas.x, -canvas.y, canvas.x + canvas.width, canvas.y + canvas.height;
    return (sides_of(positions) > sides).any();
}

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
