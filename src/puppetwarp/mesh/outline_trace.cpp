#include <puppetwarp/mesh/outline.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/base/threads.h>
#include <puppetwarp/mesh/contour_field.h>
#include <puppetwarp/mesh/nesting.h>
#include <puppetwarp/mesh/offset_field.h>
#include <puppetwarp/mesh/silhouette.h>
#include <puppetwarp/mesh/simplify.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace puppetwarp {

namespace {

// The way from matte to outline: the silhouette at half coverage grown by `expand_px`; where that leaves covered
// pixels out, the silhouette of all coverage as well; both as one distance field, whose contour is simplified as far
// as every covered pixel stays within.
class OutlineTracer {
public:
    OutlineTracer(const MatteReader& matte, const cv::Rect& support, const OutlineOptions& options)
        : matte_(matte), support_(support), options_(options) {
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
        const std::vector<cv::Rect> tiles = tiles_with_uncovered(field);
        std::vector<std::optional<ContourField>> additions(tiles.size());
        parallel_for(0, static_cast<int>(tiles.size()), 1, [&](int first, int last) {
            for (int k = first; k < last; ++k) {
                additions[static_cast<std::size_t>(k)] = support_field(tiles[static_cast<std::size_t>(k)]);
            }
        });
        for (const std::optional<ContourField>& addition : additions) unite(field, *addition);
        for (const cv::Rect& tile : tiles) {
            for (int y = tile.y; y < tile.br().y; ++y) cover_row(field, y, tile.x, tile.br().x);
        }
        return field;
    }

    // The silhouette of all coverage in and around a tile, grown as far as it needs. Where the window cuts the
    // subject, its neighbours' windows or the silhouette at half coverage go on.
    ContourField support_field(const cv::Rect& tile) const {
        constexpr int overlap = 32;
        const cv::Rect window =
            cv::Rect(tile.x - overlap, tile.y - overlap, tile.width + 2 * overlap, tile.height + 2 * overlap) &
            cv::Rect(0, 0, matte_.columns(), matte_.rows());
        const MatteReader part = matte_.window(window);
        std::vector<GrownPolygon> grown =
            radii_for_support(trace_silhouette(part, SilhouetteLevel::support), part, tolerance() + 0.02);
        for (GrownPolygon& polygon : grown) {
            for (Point& point : polygon.points) point += Point(window.x, window.y);
        }
        constexpr int reach = 5;  // what a support silhouette can be grown by, and a node beyond
        const int first_column = std::max(0, node_column(window.x) - reach);
        const int first_row = std::max(0, node_row(window.y) - reach);
        ContourField support(left_ + first_column, top_ + first_row,
                             std::min(columns_, node_column(window.br().x) + reach + 2) - first_column,
                             std::min(rows_, node_row(window.br().y) + reach + 2) - first_row);
        fill_offset(support, in_nodes(std::move(grown)));
        return support;
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

    // \param mask  255 for each covered pixel from `first` on.
    bool row_has_uncovered(const ContourField& field, int y, int first, std::span<const std::uint8_t> mask) const {
        const int j = node_row(y);
        if (spacing_ == 1) {
            const std::int8_t* upper = field.row(j) + (first - left_);
            const std::int8_t* lower = field.row(j + 1) + (first - left_);
            std::uint8_t outside = 0;
            for (std::size_t x = 0; x < mask.size(); ++x) {
                const std::int8_t least = std::min(std::min(upper[x], upper[x + 1]), std::min(lower[x], lower[x + 1]));
                outside |= static_cast<std::uint8_t>((least <= 0 ? 255 : 0) & mask[x]);
            }
            return outside != 0;
        }
        for (std::size_t x = 0; x < mask.size(); ++x) {
            if (mask[x] && !square_inside(field, node_column(first + static_cast<int>(x)), j)) return true;
        }
        return false;
    }

    bool tile_has_uncovered(const ContourField& field, const cv::Rect& tile) const {
        std::vector<std::uint8_t> mask(static_cast<std::size_t>(tile.width));
        for (int y = tile.y; y < tile.br().y; ++y) {
            if (matte_.uniform(y, tile.x, tile.br().x) == MatteReader::Uniform::uncovered) continue;
            matte_.support_span(y, tile.x, mask);
            if (row_has_uncovered(field, y, tile.x, mask)) return true;
        }
        return false;
    }

    // Tiles of the picture in which covered pixels are not within the field, row by row.
    std::vector<cv::Rect> tiles_with_uncovered(const ContourField& field) const {
        constexpr int size = 256;
        std::vector<cv::Rect> tiles;
        for (int y = support_.y; y < support_.br().y; y += size) {
            for (int x = support_.x; x < support_.br().x; x += size) {
                tiles.push_back(cv::Rect(x, y, size, size) & support_);
            }
        }
        std::vector<std::uint8_t> uncovered(tiles.size(), 0);
        parallel_for(0, static_cast<int>(tiles.size()), 4, [&](int first, int last) {
            for (auto k = static_cast<std::size_t>(first); k < static_cast<std::size_t>(last); ++k) {
                uncovered[k] = tile_has_uncovered(field, tiles[k]);
            }
        });
        std::vector<cv::Rect> found;
        for (std::size_t k = 0; k < tiles.size(); ++k) {
            if (uncovered[k]) found.push_back(tiles[k]);
        }
        return found;
    }

    // Takes the squares of covered pixels in by force, with a quarter of a node's distance around them.
    void cover_row(ContourField& field, int y, int first, int last) const {
        const auto raise = [&](int i, int j, int value) {
            std::int8_t& node = field.row(j)[i];
            node = std::max(ContourField::value(node), static_cast<std::int8_t>(value));
        };
        const int j = node_row(y);
        for (int x = first; x < last; ++x) {
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
    cv::Rect support_;  // the box of all covered pixels
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
