#include <puppetwarp/warp/spans.h>

#include <puppetwarp/base/threads.h>
#include <puppetwarp/warp/coverage_bits.h>

#include <atomic>
#include <cmath>

namespace puppetwarp::detail {

namespace {

constexpr int coverage_band_rows = 128;

}  // namespace

std::int64_t snapped(double coordinate, int origin) {
    return static_cast<std::int64_t>(std::floor((coordinate - origin) * static_cast<double>(subpixel_one) + 0.5));
}

SnappedMesh::SnappedMesh(const TriangleMesh& rest, const Eigen::MatrixX2d& moved, const Canvas& canvas,
                         BackFaces back_faces)
    : faces_(rest.F), canvas_(canvas), back_faces_(back_faces) {
    points_.reserve(static_cast<std::size_t>(moved.rows()));
    for (Eigen::Index i = 0; i < moved.rows(); ++i) {
        points_.push_back({snapped(moved(i, 0), canvas.x), snapped(moved(i, 1), canvas.y)});
    }
    rows_.reserve(static_cast<std::size_t>(rest.F.rows()));
    shows_.reserve(rows_.capacity());
    for (int triangle = 0; triangle < rest.F.rows(); ++triangle) {
        shows_.push_back(what_shows(triangle, rest.V));
        rows_.push_back(rows_of(triangle));
    }
    block_rows_.resize((rows_.size() + block_triangles - 1) / block_triangles);
    for (std::size_t first = 0; first < rows_.size(); first += block_triangles) {
        RowRange block{canvas.height + 1, -1};  // meets no band
        for (std::size_t i = first; i < std::min(first + block_triangles, rows_.size()); ++i) {
            if (shows_[i] == Shows::nothing) continue;
            block = {std::min(block.first, rows_[i].first), std::max(block.last, rows_[i].last)};
        }
        block_rows_[first / block_triangles] = block;
    }
}

SnappedMesh::Shows SnappedMesh::what_shows(int triangle, const Eigen::MatrixX2d& rest) const {
    const Eigen::RowVector2d p = rest.row(faces_(triangle, 0));
    const Eigen::RowVector2d ab = rest.row(faces_(triangle, 1)) - p;
    const Eigen::RowVector2d ac = rest.row(faces_(triangle, 2)) - p;
    const double rest_area = ab.x() * ac.y() - ab.y() * ac.x();
    const Int128 area = snapped_double_area(corner(triangle, 0), corner(triangle, 1), corner(triangle, 2));
    if (area == 0 || rest_area == 0) return Shows::nothing;
    if ((area > 0) == (rest_area > 0)) return Shows::front;
    return back_faces_ == BackFaces::show ? Shows::back : Shows::nothing;
}

RowRange SnappedMesh::rows_of(int triangle) const {
    const SnappedPoint a = corner(triangle, 0), b = corner(triangle, 1), c = corner(triangle, 2);
    if (!drawn(triangle)) return {};
    if (std::max({a.x, b.x, c.x}) <= 0 || std::min({a.x, b.x, c.x}) >= canvas_.width * subpixel_one) return {};
    const auto clamped = [&](std::int64_t row) {
        return static_cast<int>(std::clamp<std::int64_t>(row, 0, canvas_.height));
    };
    return {clamped(first_centre(std::min({a.y, b.y, c.y}))), clamped(first_centre(std::max({a.y, b.y, c.y})))};
}

bool SnappedMesh::covers(RowRange band) const {
    CoverageBits bits(band, canvas_.width);
    for_each_triangle_in(band, [&](int triangle) {
        for_each_span_of(triangle, band, [&](int row, int first, int last) { bits.add(row, first, last); });
    });
    bool all = true;
    for (int row = band.first; row < band.last; ++row) bits.for_each_gap(row, [&](int, int) { all = false; });
    return all;
}

int SnappedMesh::layers_on_first_pixel() const {
    int layers = 0;
    for_each_triangle_in({0, 1}, [&](int triangle) {
        for_each_span_of(triangle, {0, 1}, [&](int, int first, int) { layers += first == 0 ? 1 : 0; });
    });
    return layers;
}

bool SnappedMesh::covers_canvas() const {
    std::atomic<bool> all = true;
    parallel_for(0, canvas_.height, coverage_band_rows, [&](int first, int last) {
        if (all.load(std::memory_order_relaxed) && !covers({first, last})) all = false;
    });
    return all;
}

}  // namespace puppetwarp::detail
