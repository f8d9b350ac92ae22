#include <puppetwarp/warp/spans.h>

#include <puppetwarp/base/threads.h>

#include <atomic>
#include <cmath>

namespace puppetwarp::detail {

namespace {

constexpr int coverage_band_rows = 128;

//! One bit a pixel: what triangles have covered of a few rows.
class CoverageBits {
public:
    CoverageBits(RowRange rows, int width)
        : first_row_(rows.first),
          width_(width),
          words_a_row_((static_cast<std::size_t>(width) + 63) / 64),
          words_(words_a_row_ * static_cast<std::size_t>(rows.last - rows.first)) {}

    void set(int row, int first, int last) {
        std::uint64_t* words = words_.data() + words_a_row_ * static_cast<std::size_t>(row - first_row_);
        const auto head = static_cast<std::size_t>(first) / 64;
        const auto tail = static_cast<std::size_t>(last - 1) / 64;
        const std::uint64_t from_first = ~std::uint64_t{0} << (first % 64);
        const std::uint64_t to_last = ~std::uint64_t{0} >> (63 - (last - 1) % 64);
        if (head == tail) {
            words[head] |= from_first & to_last;
            return;
        }
        words[head] |= from_first;
        std::fill(words + head + 1, words + tail, ~std::uint64_t{0});
        words[tail] |= to_last;
    }

    bool all() const {
        const std::uint64_t last_word = ~std::uint64_t{0} >> (63 - (width_ - 1) % 64);
        for (std::size_t i = 0; i < words_.size(); ++i) {
            const bool ends_row = (i + 1) % words_a_row_ == 0;
            if (words_[i] != (ends_row ? last_word : ~std::uint64_t{0})) return false;
        }
        return true;
    }

private:
    int first_row_;
    int width_;
    std::size_t words_a_row_;
    std::vector<std::uint64_t> words_;
};

std::int64_t snapped(double coordinate, int origin) {
    return static_cast<std::int64_t>(std::floor((coordinate - origin) * static_cast<double>(subpixel_one) + 0.5));
}

}  // namespace

SnappedMesh::SnappedMesh(const TriangleMesh& rest, const Eigen::MatrixX2d& moved, const Canvas& canvas,
                         BackFaces back_faces)
    : faces_(rest.F), canvas_(canvas), back_faces_(back_faces) {
    points_.reserve(static_cast<std::size_t>(moved.rows()));
    for (Eigen::Index i = 0; i < moved.rows(); ++i) {
        points_.push_back({snapped(moved(i, 0), canvas.x), snapped(moved(i, 1), canvas.y)});
    }
    rows_.reserve(static_cast<std::size_t>(rest.F.rows()));
    for (int triangle = 0; triangle < rest.F.rows(); ++triangle) rows_.push_back(rows_of(triangle, rest.V));
    block_rows_.resize((rows_.size() + block_triangles - 1) / block_triangles);
    for (std::size_t i = 0; i < rows_.size(); ++i) {
        if (rows_[i].first >= rows_[i].last) continue;
        RowRange& block = block_rows_[i / block_triangles];
        const bool none = block.first >= block.last;
        block = none ? rows_[i] : RowRange{std::min(block.first, rows_[i].first), std::max(block.last, rows_[i].last)};
    }
}

RowRange SnappedMesh::rows_of(int triangle, const Eigen::MatrixX2d& rest) const {
    const SnappedPoint a = corner(triangle, 0), b = corner(triangle, 1), c = corner(triangle, 2);
    const Eigen::RowVector2d p = rest.row(faces_(triangle, 0));
    const Eigen::RowVector2d ab = rest.row(faces_(triangle, 1)) - p;
    const Eigen::RowVector2d ac = rest.row(faces_(triangle, 2)) - p;
    const double rest_area = ab.x() * ac.y() - ab.y() * ac.x();
    const Int128 area = snapped_double_area(a, b, c);
    if (area == 0 || rest_area == 0) return {};
    const bool turned_over = (area > 0) != (rest_area > 0);
    if (turned_over && back_faces_ == BackFaces::hide) return {};
    if (std::max({a.x, b.x, c.x}) <= 0 || std::min({a.x, b.x, c.x}) >= canvas_.width * subpixel_one) return {};
    const auto clamped = [&](std::int64_t row) {
        return static_cast<int>(std::clamp<std::int64_t>(row, 0, canvas_.height));
    };
    return {clamped(first_centre(std::min({a.y, b.y, c.y}))), clamped(first_centre(std::max({a.y, b.y, c.y})))};
}

bool SnappedMesh::covers(RowRange band) const {
    CoverageBits bits(band, canvas_.width);
    for_each_triangle_in(band, [&](int triangle) {
        for_each_span_of(triangle, band, [&](int row, int first, int last) { bits.set(row, first, last); });
    });
    return bits.all();
}

bool SnappedMesh::covers_canvas() const {
    std::atomic<bool> all = true;
    parallel_for(0, canvas_.height, coverage_band_rows, [&](int first, int last) {
        if (all.load(std::memory_order_relaxed) && !covers({first, last})) all = false;
    });
    return all;
}

}  // namespace puppetwarp::detail
