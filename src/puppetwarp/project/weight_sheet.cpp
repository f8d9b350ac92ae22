#include <puppetwarp/project/weight_sheet.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/project/overlay.h>
#include <puppetwarp/project/sheet_cell.h>
#include <puppetwarp/project/sheet_layout.h>
#include <puppetwarp/project/weight_colours.h>

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <optional>
#include <utility>

namespace puppetwarp {

namespace {

constexpr int smallest_cell_px = 120;
constexpr int largest_cell_px = 2000;
constexpr int most_columns = 64;
constexpr int oversampling = 2;  // maps are drawn this much larger, then averaged
const TextStyle header_style{12, true, {20, 20, 20}};
const cv::Scalar paper(255, 255, 255);
const cv::Scalar ground(236, 238, 240);
const cv::Scalar frame_colour(205, 205, 205);
const HandleStyle own_style{{1.0, 0.75, 0.0}, {0.0, 0.0, 0.0}, 0.8};         // of the handle whose map it is
const HandleStyle other_style{{0.80, 0.82, 0.85}, {0.45, 0.47, 0.50}, 0.5};  // small, to hide little of the map

void require_sound(const WeightSheetOptions& options) {
    if (options.cell_px < smallest_cell_px || options.cell_px > largest_cell_px) {
        throw InvalidInput("cell size " + std::to_string(options.cell_px), "is out of range",
                           "use " + std::to_string(smallest_cell_px) + " to " + std::to_string(largest_cell_px));
    }
    if (options.columns < 0 || options.columns > most_columns) {
        throw InvalidInput("columns " + std::to_string(options.columns), "is out of range",
                           "use 1 to " + std::to_string(most_columns) + ", or 0 to have them chosen");
    }
}

// Meshes may be of size 1 as well as of 4000: maps are drawn in the units of a mesh of a convenient size.
constexpr double drawn_size = 1000;

// What lies in image space moved and scaled so that all of it, cages too, is of `drawn_size`.
struct Drawn {
    TriangleMesh mesh;
    Rig rig;
};

struct Scaler {
    Eigen::RowVector2d origin;
    double scale;

    Point operator()(const Point& p) const { return (p - origin.transpose()) * scale; }
    Polyline operator()(Polyline points) const {
        for (Point& p : points) p = (*this)(p);
        return points;
    }
    void operator()(PointHandle& point) const {
        point.at = (*this)(point.at);
        if (point.radius_px) *point.radius_px *= scale;
    }
    void operator()(BoneHandle& bone) const {
        bone.from = (*this)(bone.from);
        bone.to = (*this)(bone.to);
    }
    void operator()(CageHandle& cage) const { cage.points = (*this)(cage.points); }
    void operator()(RegionHandle& region) const { region.points = (*this)(region.points); }
    void operator()(VertexHandle&) const {}
};

// Vertices are shown as points: a handle by itself does not know where it is.
void make_visible(Rig& rig, const TriangleMesh& mesh) {
    for (Handle& handle : rig.handles) {
        const auto* vertex = std::get_if<VertexHandle>(&handle.shape);
        if (vertex != nullptr) handle.shape = PointHandle{mesh.V.row(vertex->index).transpose(), std::nullopt};
    }
}

Drawn drawn_of(const TriangleMesh& mesh, const Rig& rig) {
    Eigen::RowVector2d low = mesh.V.colwise().minCoeff(), high = mesh.V.colwise().maxCoeff();
    for (const Handle& handle : rig.handles) {
        const auto* cage = std::get_if<CageHandle>(&handle.shape);
        if (cage == nullptr) continue;
        for (const Point& p : cage->points) {
            low = low.cwiseMin(p.transpose());
            high = high.cwiseMax(p.transpose());
        }
    }
    const Scaler scaled{low, drawn_size / (high - low).maxCoeff()};
    Drawn drawn{mesh, rig};
    drawn.mesh.V = (mesh.V.rowwise() - low) * scaled.scale;
    for (Handle& handle : drawn.rig.handles) std::visit(scaled, handle.shape);
    make_visible(drawn.rig, drawn.mesh);
    return drawn;
}

Canvas view_of(const Drawn& drawn) {
    Eigen::MatrixX2d all = drawn.mesh.V;
    for (const Handle& handle : drawn.rig.handles) {
        const auto* cage = std::get_if<CageHandle>(&handle.shape);
        if (cage == nullptr) continue;
        for (const Point& p : cage->points) {
            all.conservativeResize(all.rows() + 1, Eigen::NoChange);
            all.bottomRows<1>() = p.transpose();
        }
    }
    return common_view(all, {});
}

SheetLayout layout_of(const Canvas& view, std::size_t maps, const WeightSheetOptions& options) {
    const double scale = static_cast<double>(options.cell_px) / std::max(view.width, view.height);
    const auto scaled = [&](int side) { return std::max(1, static_cast<int>(std::lround(side * scale))); };
    SheetContents contents;
    contents.cells = static_cast<int>(maps);
    contents.columns = options.columns;
    contents.picture_width = scaled(view.width);
    contents.picture_height = scaled(view.height);
    contents.text_height = cell_text_height(false);
    contents.header_height = header_style.line_px();
    contents.footer_height = weight_legend_height();
    return SheetLayout(contents);
}

std::string range_of(const Eigen::VectorXd& weight) {
    // Noughts without a sign, whatever the round-off.
    const auto shown = [](double value) { return std::abs(value) < 5e-5 ? 0.0 : value; };
    std::array<char, 64> text{};
    std::snprintf(text.data(), text.size(), "%.4g to %.4g", shown(weight.minCoeff()), shown(weight.maxCoeff()));
    return text.data();
}

// What a column of weights belongs to, alone: the handle, or the corner of a cage.
Rig owner_of(const Rig& rig, const WeightColumn& column) {
    Handle handle = rig.handles[static_cast<std::size_t>(column.handle)];
    if (const auto* cage = std::get_if<CageHandle>(&handle.shape)) {
        handle.shape = PointHandle{cage->points[static_cast<std::size_t>(column.corner)], std::nullopt};
    } else if (auto* bone = std::get_if<BoneHandle>(&handle.shape)) {
        bone->parent.clear();
    }
    Rig owner;
    owner.handles.push_back(std::move(handle));
    return owner;
}

cv::Mat heat_map(const Drawn& drawn, const WeightColumn& column, const Eigen::VectorXd& weight, const Canvas& view,
                 const cv::Size& size) {
    const double scale =
        static_cast<double>(oversampling) * std::max(size.width, size.height) / std::max(view.width, view.height);
    Image large;
    large.pixels = cv::Mat(oversampling * size.height, oversampling * size.width, CV_8UC3, ground);
    draw_weight(large.pixels, drawn.mesh, weight, view, scale);
    draw_handles(large, drawn.rig, Pose(), view, scale, other_style);
    draw_handles(large, owner_of(drawn.rig, column), Pose(), view, scale, own_style);
    cv::Mat map;
    cv::resize(large.pixels, map, size, 0, 0, cv::INTER_AREA);
    return map;
}

}  // namespace

Image draw_weight_sheet(const TriangleMesh& mesh, const Rig& rig, const Weights& weights, const std::string& title,
                        const WeightSheetOptions& options, Progress& progress) {
    require_sound(options);
    const Drawn drawn = drawn_of(mesh, rig);
    const Canvas view = view_of(drawn);
    const SheetLayout layout = layout_of(view, weights.columns.size(), options);
    const cv::Size size = layout.size();
    if (std::int64_t{size.width} * size.height > options.max_pixels) {
        throw InvalidInput("sheet",
                           "would have " + std::to_string(size.width) + " x " + std::to_string(size.height) +
                               " pixels, more than " + std::to_string(options.max_pixels),
                           "ask for smaller cells");
    }
    Image sheet;
    sheet.pixels = cv::Mat(size, CV_8UC3, paper);
    const cv::Rect header = layout.header(), footer = layout.footer();
    for (const std::string& line : wrapped(title, header_style, header.width, 1)) {
        draw_text(sheet.pixels, line, header_style, header.x, header.y);
    }
    for (std::size_t c = 0; c < weights.columns.size(); ++c) {
        progress.step("draw", static_cast<double>(c) / static_cast<double>(weights.columns.size()));
        const Eigen::VectorXd weight = weights.W.col(static_cast<Eigen::Index>(c));
        const cv::Rect place = layout.picture(static_cast<int>(c));
        heat_map(drawn, weights.columns[c], weight, view, place.size()).copyTo(sheet.pixels(place));
        cv::rectangle(sheet.pixels, cv::Rect(place.x - 1, place.y - 1, place.width + 2, place.height + 2), frame_colour,
                      1);
        write_lines(sheet.pixels, column_name(rig, weights.columns[c]), {range_of(weight)},
                    layout.text(static_cast<int>(c)));
    }
    draw_weight_legend(sheet.pixels, footer.x, footer.y, footer.width);
    return sheet;
}

}  // namespace puppetwarp
