#include <puppetwarp/mesh/outline.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/base/threads.h>
#include <puppetwarp/mesh/contour_field.h>
#include <puppetwarp/mesh/nesting.h>
#include <puppetwarp/mesh/offset_field.h>
#include <puppetwarp/mesh/silhouette.h>
#include <puppetwarp/mesh/simplify.h>

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cmath>

namespace puppetwarp {

namespace {

// The way from matte to outline: the silhouette at half coverage grown by `expand_px`; where that leaves covered
// pixels out, the silhouette of all coverage as well; both as one distance field, whose contour is simplified as far
// as every covered pixel stays within.
class OutlineTracer {
public:
    OutlineTracer(const MatteReader& matte, const cv::Rect& support, const OutlineOptions& options)
        : matte_(matte), options_(options) {
        // Far growth has no fine detail: coarser nodes, an exact power of two of pixels apart.
        while (options.expand_px > 64 * spacing_) spacing_ *= 2;
        const double reach = std::max(options.expand_px / spacing_, 2.0) + 3;
        const auto first = [&](int pixel) { return static_cast<int>(std::floor(pixel / spacing_ - reach)); };
        const auto end = [&](int pixel) { return static_cast<int>(std::ceil(pixel / spacing_ + reach)); };
        left_ = first(support.x);
        top_ = first(support.y);
        columns_ = end(support.x + support.width) - left_ + 1;
        rows_ = end(support.y + support.height) - top_ + 1;
    }

    Outline trace() const {
        const ContourField field = grown_field();
        const std::vector<Contour> contours = trace_contours(field);
        std::vector<Polyline> loops;
        for (const Contour& contour : contours) {
            Polyline& loop = loops.emplace_back();
            for (const Crossing& crossing : contour) loop.push_back(spacing_ * crossing_point(field, crossing));
        }
        std::vector<Polyline> polygons =
            simplify(loops, tolerance(), [&](const Point& a, const Point& b) { return cuts_coverage(a, b); });
        return nested(contours, std::move(polygons), options_.min_hole_area_px2);
    }

private:
    // How far simplification goes: below a pixel's width, because then no pixel can lie between an edge and what it
    // replaces; and less than allowed, because the other steps err too.
    double tolerance() const { return std::min(0.4 * options_.max_deviation_px, 0.9); }

    ContourField new_field() const { return {static_cast<double>(left_), static_cast<double>(top_), columns_, rows_}; }

    ContourField grown_field() const {
        ContourField field = new_field();
        std::vector<GrownPolygon> grown;
        for (Polyline& polygon : trace_silhouette(matte_, SilhouetteLevel::half)) {
            grown.push_back({std::move(polygon), {}});
            grown.back().radii.assign(grown.back().points.size(), options_.expand_px);
        }
        fill_offset(field, in_nodes(std::move(grown)));
        if (rows_with_uncovered(field).empty()) return field;
        ContourField support = new_field();
        const std::vector<Polyline> silhouette = trace_silhouette(matte_, SilhouetteLevel::support);
        fill_offset(support, in_nodes(radii_for_support(silhouette, matte_, tolerance() + 0.02)));
        unite(field, support);
        for (const int y : rows_with_uncovered(field)) cover_row(field, y);
        return field;
    }

    std::vector<GrownPolygon> in_nodes(std::vector<GrownPolygon> polygons) const {
        for (GrownPolygon& polygon : polygons) {
            for (Point& point : polygon.points) point /= spacing_;
            for (double& radius : polygon.radii) radius /= spacing_;
        }
        return polygons;
    }

    int node_column(int pixel) const { return static_cast<int>(std::floor(pixel / spacing_)) - left_; }
    int node_row(int pixel) const { return static_cast<int>(std::floor(pixel / spacing_)) - top_; }

    // A square of nodes lies within the contours where its four nodes do; a pixel where its square does.
    bool square_inside(const ContourField& field, int i, int j) const {
        return field.inside(i, j) && field.inside(i + 1, j) && field.inside(i, j + 1) && field.inside(i + 1, j + 1);
    }

    bool row_has_uncovered(const ContourField& field, int y, const std::vector<std::uint8_t>& mask) const {
        const int j = node_row(y);
        if (spacing_ == 1) {
            const std::int8_t* upper = field.row(j) - left_;
            const std::int8_t* lower = field.row(j + 1) - left_;
            int outside = 0;
            const int end = std::min(matte_.columns(), columns_ - 1 + left_);
            for (int x = std::max(0, left_); x < end; ++x) {
                const int signs = upper[x] | upper[x + 1] | lower[x] | lower[x + 1];
                outside |= signs & mask[static_cast<std::size_t>(x)];
            }
            return (outside & 0x80) != 0;
        }
        for (int x = 0; x < matte_.columns(); ++x) {
            if (mask[static_cast<std::size_t>(x)] && !square_inside(field, node_column(x), j)) return true;
        }
        return false;
    }

    std::vector<int> rows_with_uncovered(const ContourField& field) const {
        std::vector<std::uint8_t> flags(static_cast<std::size_t>(matte_.rows()), 0);
        const int first_row = std::max(0, static_cast<int>((top_ + 1) * spacing_));
        const int end_row = std::min<int>(matte_.rows(), static_cast<int>((top_ + rows_ - 2) * spacing_));
        parallel_for(first_row, end_row, 64, [&](int first, int last) {
            std::vector<std::uint8_t> mask(static_cast<std::size_t>(matte_.columns()));
            for (int y = first; y < last; ++y) {
                matte_.support_row(y, mask);
                flags[static_cast<std::size_t>(y)] = row_has_uncovered(field, y, mask);
            }
        });
        std::vector<int> rows;
        for (int y = 0; y < matte_.rows(); ++y) {
            if (flags[static_cast<std::size_t>(y)]) rows.push_back(y);
        }
        return rows;
    }

    // Takes the squares of covered pixels in by force, with a quarter of a node's distance around them.
    void cover_row(ContourField& field, int y) const {
        const auto raise = [&](int i, int j, int value) {
            std::int8_t& node = field.row(j)[i];
            node = std::max(node, static_cast<std::int8_t>(value));
        };
        const int j = node_row(y);
        for (int x = 0; x < matte_.columns(); ++x) {
            if (!matte_.covered(x, y)) continue;
            const int i = node_column(x);
            if (square_inside(field, i, j)) continue;
            for (int dj = 0; dj < 2; ++dj) {
                for (int di = 0; di < 2; ++di) {
                    raise(i + di, j + dj, 32);
                    for (const auto& step : grid_steps) raise(i + di + step[0], j + dj + step[1], -95);
                }
            }
        }
    }

    // Whether the segment passes through the square of a covered pixel, its border taken in.
    bool cuts_coverage(const Point& a, const Point& b) const {
        constexpr double slack = 1e-6;
        const Point& top = a.y() <= b.y() ? a : b;
        const Point& bottom = a.y() <= b.y() ? b : a;
        const double height = bottom.y() - top.y();
        const int last_row = std::min(matte_.rows() - 1, static_cast<int>(std::floor(bottom.y() + slack)));
        for (int y = std::max(0, static_cast<int>(std::floor(top.y() - slack))); y <= last_row; ++y) {
            const double from = height > 0 ? std::clamp((y - slack - top.y()) / height, 0.0, 1.0) : 0;
            const double to = height > 0 ? std::clamp((y + 1 + slack - top.y()) / height, 0.0, 1.0) : 1;
            const double x0 = top.x() + from * (bottom.x() - top.x()), x1 = top.x() + to * (bottom.x() - top.x());
            const int last = static_cast<int>(std::floor(std::max(x0, x1) + slack));
            for (int x = static_cast<int>(std::floor(std::min(x0, x1) - slack)); x <= last; ++x) {
                if (matte_.covered(x, y)) return true;
            }
        }
        return false;
    }

    const MatteReader& matte_;
    const OutlineOptions& options_;
    double spacing_ = 1;  // pixels between nodes
    int left_, top_;      // of the field's first node, in nodes from the picture's corner
    int columns_, rows_;
};

void require_sound(const OutlineOptions& options) {
    if (!std::isfinite(options.max_deviation_px) || options.max_deviation_px <= 0) {
        throw InvalidInput("max_deviation_px", "must be a length above 0");
    }
    if (!std::isfinite(options.expand_px) || options.expand_px < 0 || options.expand_px > 1e6) {
        throw InvalidInput("expand_px", "must be a length from 0 to 1000000 pixels");
    }
    if (!std::isfinite(options.min_hole_area_px2) || options.min_hole_area_px2 < 0) {
        throw InvalidInput("min_hole_area_px2", "must be an area of at least 0");
    }
}

}  // namespace

Outline trace_outline(const cv::Mat& matte, const OutlineOptions& options) {
    assert(matte.empty() || matte.type() == CV_8UC1 || matte.type() == CV_16UC1 || matte.type() == CV_32FC1);
    require_sound(options);
    const MatteReader reader(matte);
    const cv::Rect support = matte.empty() ? cv::Rect() : reader.support_box();
    if (support.empty()) throw InvalidInput("subject", "nothing is visible", "choose a cutout that keeps some pixels");
    return OutlineTracer(reader, support, options).trace();
}

}  // namespace puppetwarp
