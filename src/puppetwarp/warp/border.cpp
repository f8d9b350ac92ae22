#include <puppetwarp/warp/border.h>

#include <puppetwarp/base/point.h>
#include <puppetwarp/base/threads.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <tuple>

namespace puppetwarp::detail {

namespace {

constexpr int band_rows = 64;

// Pixels that miss less are covered, pixels that have less are not: the solver's noise (translation_tolerance_px along
// two edges) blurs no border that lies between pixels.
constexpr double whole_tolerance = 2e-4;

struct Point2 {
    double x, y;
};

Point2 in_pixels(SnappedPoint p) {
    constexpr double scale = 1.0 / static_cast<double>(subpixel_one);
    return {static_cast<double>(p.x) * scale, static_cast<double>(p.y) * scale};
}

// Which triangles meet at each vertex.
class Corners {
public:
    explicit Corners(const Eigen::MatrixX3i& faces) {
        const int vertices = faces.size() == 0 ? 0 : faces.maxCoeff() + 1;
        starts_.assign(static_cast<std::size_t>(vertices) + 1, 0);
        for (Eigen::Index i = 0; i < faces.size(); ++i) ++starts_[static_cast<std::size_t>(faces.data()[i]) + 1];
        for (std::size_t i = 1; i < starts_.size(); ++i) starts_[i] += starts_[i - 1];
        triangles_.resize(static_cast<std::size_t>(faces.size()));
        std::vector<int> next(starts_.begin(), starts_.end() - 1);
        for (int f = 0; f < faces.rows(); ++f) {
            for (int k = 0; k < 3; ++k) {
                int& at = next[static_cast<std::size_t>(faces(f, k))];
                triangles_[static_cast<std::size_t>(at++)] = f;
            }
        }
    }

    //! In the order of their indices.
    std::span<const int> at(int vertex) const {
        const auto first = static_cast<std::size_t>(starts_[static_cast<std::size_t>(vertex)]);
        const auto last = static_cast<std::size_t>(starts_[static_cast<std::size_t>(vertex) + 1]);
        return {triangles_.data() + first, last - first};
    }

private:
    std::vector<int> starts_, triangles_;
};

bool crosses_canvas(SnappedPoint a, SnappedPoint b, const Canvas& canvas) {
    const auto meets = [](std::int64_t p, std::int64_t q, int size) {
        return std::max(p, q) > 0 && std::min(p, q) < size * subpixel_one;
    };
    return meets(a.x, b.x, canvas.width) && meets(a.y, b.y, canvas.height);
}

auto key(SnappedPoint p) {
    return std::tuple(p.x, p.y);
}

// Two edges in one place have no border between them, but for the two of a fold.
void drop_cuts(const SnappedMesh& mesh, std::vector<BorderEdge>& edges) {
    // From lower to higher end: the same for both edges of a cut.
    const auto place = [&](const BorderEdge& edge) {
        const auto a = key(edge.a), b = key(edge.b);
        return std::tuple(mesh.flipped(edge.triangle), std::min(a, b), std::max(a, b));
    };
    std::sort(edges.begin(), edges.end(), [&](const BorderEdge& one, const BorderEdge& other) {
        return std::pair(place(one), one.triangle) < std::pair(place(other), other.triangle);
    });
    std::vector<BorderEdge> kept;
    for (std::size_t i = 0; i < edges.size(); ++i) {
        const bool cut = i + 1 < edges.size() && place(edges[i]) == place(edges[i + 1]);
        if (cut) {
            ++i;
        } else {
            kept.push_back(edges[i]);
        }
    }
    edges = std::move(kept);
}

struct Rectangle {
    double left, top, right, bottom;
    double area() const { return std::max(right - left, 0.0) * std::max(bottom - top, 0.0); }
};

// What a triangle covers of a rectangle.
class ClippedPolygon {
public:
    ClippedPolygon(const std::array<Point2, 3>& triangle, const Rectangle& r) {
        // From the corner of the rectangle on: small numbers.
        for (const Point2& p : triangle) points_[count_++] = {p.x - r.left, p.y - r.top};
        const double width = r.right - r.left, height = r.bottom - r.top;
        clip([](Point2 p) { return p.x; });
        clip([&](Point2 p) { return width - p.x; });
        clip([](Point2 p) { return p.y; });
        clip([&](Point2 p) { return height - p.y; });
    }

    double area() const {
        double twice = 0;
        for (std::size_t i = 0; i < count_; ++i) {
            const Point2 p = points_[i], q = points_[(i + 1) % count_];
            twice += p.x * q.y - p.y * q.x;
        }
        return std::abs(twice) / 2;
    }

private:
    // Keeps what lies where `inside` is at least 0.
    template <class Inside>
    void clip(const Inside& inside) {
        std::array<Point2, 8> kept{};
        std::size_t kept_count = 0;
        for (std::size_t i = 0; i < count_; ++i) {
            const Point2 p = points_[i], q = points_[(i + 1) % count_];
            const double at_p = inside(p), at_q = inside(q);
            if (at_p >= 0) kept[kept_count++] = p;
            if ((at_p >= 0) == (at_q >= 0)) continue;
            const double t = at_p / (at_p - at_q);
            kept[kept_count++] = {p.x + (q.x - p.x) * t, p.y + (q.y - p.y) * t};
        }
        points_ = kept;
        count_ = kept_count;
    }

    std::array<Point2, 8> points_{};
    std::size_t count_ = 0;
};

// A bit for each place of a grid over a pixel.
using SampledPlaces = std::uint64_t;
constexpr int places_along = 8;
constexpr SampledPlaces all_places = ~SampledPlaces{0};

// An edge in a pixel.
struct Crossing {
    int row, x;
    int edge;
    auto order() const { return std::tuple(row, x, edge); }
};

class Finder {
public:
    Finder(const Eigen::MatrixX3i& faces, const SnappedMesh& mesh, const std::vector<BorderEdge>& edges,
           const Eigen::AlignedBox2d& frame)
        : faces_(faces), mesh_(mesh), edges_(edges), corners_(faces) {
        const Canvas& canvas = mesh.canvas();
        frame_ = {0, 0, static_cast<double>(canvas.width), static_cast<double>(canvas.height)};
        if (frame.isEmpty()) return;
        const Eigen::Vector2d low = frame.min() - Eigen::Vector2d(canvas.x, canvas.y);
        const Eigen::Vector2d high = frame.max() - Eigen::Vector2d(canvas.x, canvas.y);
        frame_ = {low.x(), low.y(), high.x(), high.y()};
    }

    std::vector<BorderPixel> pixels_in(RowRange band) const {
        std::vector<Crossing> crossings;
        for (std::size_t i = 0; i < edges_.size(); ++i) add_crossings(static_cast<int>(i), band, crossings);
        std::sort(crossings.begin(), crossings.end(),
                  [](const Crossing& a, const Crossing& b) { return a.order() < b.order(); });
        std::vector<BorderPixel> pixels;
        for (std::size_t first = 0; first < crossings.size();) {
            std::size_t last = first + 1;
            const auto same = [&](const Crossing& c) {
                return c.row == crossings[first].row && c.x == crossings[first].x;
            };
            while (last < crossings.size() && same(crossings[last])) ++last;
            add_pixels({crossings.data() + first, last - first}, pixels);
            first = last;
        }
        return pixels;
    }

private:
    void add_crossings(int index, RowRange band, std::vector<Crossing>& crossings) const {
        const BorderEdge& edge = edges_[static_cast<std::size_t>(index)];
        Point2 upper = in_pixels(edge.a), lower = in_pixels(edge.b);
        if (lower.y < upper.y) std::swap(upper, lower);
        const double width = mesh_.canvas().width;
        const int first = static_cast<int>(std::clamp<double>(std::floor(upper.y), band.first, band.last));
        const int last = static_cast<int>(std::clamp<double>(std::floor(lower.y) + 1, band.first, band.last));
        const auto at = [&](double y) {
            return upper.x + (lower.x - upper.x) * std::clamp((y - upper.y) / (lower.y - upper.y), 0.0, 1.0);
        };
        for (int row = first; row < last; ++row) {
            const bool level = lower.y == upper.y;
            const double p = level ? upper.x : at(row), q = level ? lower.x : at(row + 1);
            const auto column = [&](double x) { return static_cast<int>(std::clamp(std::floor(x), -1.0, width)); };
            const int end = std::min(column(std::max(p, q)), mesh_.canvas().width - 1);
            for (int x = std::max(column(std::min(p, q)), 0); x <= end; ++x) crossings.push_back({row, x, index});
        }
    }

    // A triangle and how much of a pixel it covers.
    struct Piece {
        int triangle;
        double area;
    };

    // What hangs together in a pixel, and covers a part of it.
    struct Part {
        std::vector<Piece> pieces;
        std::vector<BorderPixel> entries;
    };

    // Pieces of a pixel that do not hang together in it lie over each other, or side by side.
    void add_pixels(std::span<const Crossing> crossings, std::vector<BorderPixel>& pixels) const {
        const int row = crossings.front().row, x = crossings.front().x;
        std::vector<int> left;
        for (const Crossing& crossing : crossings) {
            const int triangle = edges_[static_cast<std::size_t>(crossing.edge)].triangle;
            // One that only touches the pixel has no part in it, and would count a neighbour's a second time.
            if (covered_area(triangle, shown_of(row, x)) > 0) left.push_back(triangle);
        }
        std::vector<Part> parts;
        while (!left.empty()) {
            Part part{pieces_from(left.back(), shown_of(row, x)), {}};
            std::erase_if(left, [&](int triangle) { return holds(part.pieces, triangle); });
            const bool at_fold = std::any_of(crossings.begin(), crossings.end(), [&](const Crossing& crossing) {
                const BorderEdge& edge = edges_[static_cast<std::size_t>(crossing.edge)];
                return edge.fold && holds(part.pieces, edge.triangle);
            });
            part.entries = entries_of(row, x, part.pieces, at_fold);
            if (!part.entries.empty()) parts.push_back(std::move(part));
        }
        if (parts.size() > 1) share_out(parts, shown_of(row, x));
        for (const Part& part : parts) pixels.insert(pixels.end(), part.entries.begin(), part.entries.end());
    }

    // Of parts over each other only what shows counts, so that together they leave as much open as there is: what the
    // nearer ones leave is covered by the farther ones to the share of it in which these lie.
    void share_out(std::vector<Part>& parts, const Rectangle& shown) const {
        std::sort(parts.begin(), parts.end(),
                  [](const Part& a, const Part& b) { return a.entries.front().triangle > b.entries.front().triangle; });
        SampledPlaces open = all_places;
        for (std::size_t i = 0; i < parts.size(); ++i) {
            SampledPlaces covered = 0;
            for (const Piece& piece : parts[i].pieces) covered |= places_in(piece.triangle, shown);
            if (i > 0) {
                const int left = std::popcount(open), filled = std::popcount(open & covered);
                const float coverage = left > 0 ? static_cast<float>(filled) / static_cast<float>(left) : 1.0F;
                for (BorderPixel& entry : parts[i].entries) entry.coverage = coverage;
            }
            open &= ~covered;
        }
    }

    static bool holds(const std::vector<Piece>& part, int triangle) {
        return std::any_of(part.begin(), part.end(), [&](const Piece& piece) { return piece.triangle == triangle; });
    }

    // The triangles from one of them on that share edges, lie in the pixel, and have no fold between them.
    std::vector<Piece> pieces_from(int first, const Rectangle& shown) const {
        std::vector<Piece> part{{first, covered_area(first, shown)}};
        for (std::size_t i = 0; i < part.size(); ++i) {
            const int triangle = part[i].triangle;
            for (int k = 0; k < 3; ++k) {
                for (const int other : corners_.at(faces_(triangle, k))) {
                    if (mesh_.flipped(other) != mesh_.flipped(first) ||
                        !has_corner(other, faces_(triangle, (k + 1) % 3)))
                        continue;
                    const double area = covered_area(other, shown);
                    if (area > 0 && !holds(part, other)) part.push_back({other, area});
                }
            }
        }
        return part;
    }

    bool has_corner(int triangle, int vertex) const {
        return faces_(triangle, 0) == vertex || faces_(triangle, 1) == vertex || faces_(triangle, 2) == vertex;
    }

    // None where the part covers all, or next to nothing.
    std::vector<BorderPixel> entries_of(int row, int x, const std::vector<Piece>& part, bool at_fold) const {
        const double whole = shown_of(row, x).area();
        double covered = 0;
        Piece largest = part.front();
        for (const Piece& piece : part) {
            covered += piece.area / whole;
            if (piece.area > largest.area) largest = piece;
        }
        std::vector<BorderPixel> entries;
        if (covered < whole_tolerance || covered > 1 - whole_tolerance) return entries;
        for (const Piece& piece : part) {
            if (!holds_centre(piece.triangle, row, x)) continue;
            entries.push_back({piece.triangle, row, x, static_cast<float>(covered), true, at_fold});
        }
        if (entries.empty()) entries.push_back({largest.triangle, row, x, static_cast<float>(covered), false, at_fold});
        return entries;
    }

    // The part of a pixel that the frame holds; all of it when it holds none.
    Rectangle shown_of(int row, int x) const {
        const Rectangle pixel{static_cast<double>(x), static_cast<double>(row), x + 1.0, row + 1.0};
        const Rectangle shown{std::max(pixel.left, frame_.left), std::max(pixel.top, frame_.top),
                              std::min(pixel.right, frame_.right), std::min(pixel.bottom, frame_.bottom)};
        return shown.area() > whole_tolerance ? shown : pixel;
    }

    // Which places of a grid over the rectangle a triangle covers. On its edges they belong to both sides.
    SampledPlaces places_in(int triangle, const Rectangle& shown) const {
        std::array<Point2, 3> c;
        for (int k = 0; k < 3; ++k) c[static_cast<std::size_t>(k)] = in_pixels(mesh_.corner(triangle, k));
        const auto side = [](Point2 a, Point2 b, Point2 p) {
            return (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
        };
        const double sign = side(c[0], c[1], c[2]) < 0 ? -1 : 1;
        SampledPlaces places = 0;
        for (int i = 0; i < places_along * places_along; ++i) {
            const int row = i / places_along, column = i % places_along;
            const Point2 p{shown.left + (shown.right - shown.left) * (column + 0.5) / places_along,
                           shown.top + (shown.bottom - shown.top) * (row + 0.5) / places_along};
            bool inside = true;
            for (std::size_t k = 0; k < 3; ++k) inside &= sign * side(c[k], c[(k + 1) % 3], p) >= -1e-6;
            if (inside) places |= SampledPlaces{1} << i;
        }
        return places;
    }

    double covered_area(int triangle, const Rectangle& shown) const {
        if (!mesh_.drawn(triangle)) return 0;
        std::array<Point2, 3> corners;
        for (int k = 0; k < 3; ++k) corners[static_cast<std::size_t>(k)] = in_pixels(mesh_.corner(triangle, k));
        const std::pair<double, double> across = std::minmax({corners[0].x, corners[1].x, corners[2].x});
        const std::pair<double, double> down = std::minmax({corners[0].y, corners[1].y, corners[2].y});
        if (across.second <= shown.left || across.first >= shown.right) return 0;
        if (down.second <= shown.top || down.first >= shown.bottom) return 0;
        return ClippedPolygon(corners, shown).area();
    }

    bool holds_centre(int triangle, int row, int x) const {
        bool holds = false;
        mesh_.for_each_span_of(triangle, {row, row + 1},
                               [&](int, int first, int last) { holds = first <= x && x < last; });
        return holds;
    }

    const Eigen::MatrixX3i& faces_;
    const SnappedMesh& mesh_;
    const std::vector<BorderEdge>& edges_;
    Corners corners_;
    Rectangle frame_;  // on the canvas
};

}  // namespace

std::vector<BorderEdge> border_edges(const Eigen::MatrixX3i& faces, const SnappedMesh& mesh) {
    // Edges by their lower vertex: the few of one vertex are compared with each other.
    struct Edge {
        int upper, triangle, k;
        bool drawn, flipped;
    };
    const auto for_each_edge = [&](const auto& body) {
        for (int triangle = 0; triangle < mesh.triangle_count(); ++triangle) {
            for (int k = 0; k < 3; ++k) {
                const int i = faces(triangle, k), j = faces(triangle, (k + 1) % 3);
                body(std::min(i, j), Edge{std::max(i, j), triangle, k, mesh.drawn(triangle), mesh.flipped(triangle)});
            }
        }
    };
    const int vertices = faces.size() == 0 ? 0 : faces.maxCoeff() + 1;
    std::vector<int> starts(static_cast<std::size_t>(vertices) + 1, 0);
    for_each_edge([&](int lower, const Edge&) { ++starts[static_cast<std::size_t>(lower) + 1]; });
    for (std::size_t i = 1; i < starts.size(); ++i) starts[i] += starts[i - 1];
    std::vector<Edge> sorted(static_cast<std::size_t>(starts.back()));
    std::vector<int> next = starts;
    for_each_edge([&](int lower, const Edge& edge) {
        sorted[static_cast<std::size_t>(next[static_cast<std::size_t>(lower)]++)] = edge;
    });
    std::vector<BorderEdge> edges;
    for (std::size_t vertex = 0; vertex + 1 < starts.size(); ++vertex) {
        const std::span<const Edge> here{sorted.data() + starts[vertex], sorted.data() + starts[vertex + 1]};
        for (const Edge& edge : here) {
            if (!edge.drawn) continue;
            const auto shares = [&](const Edge& other) { return other.upper == edge.upper; };
            const auto same = [&](const Edge& other) {
                return shares(other) && other.drawn && other.flipped == edge.flipped;
            };
            if (std::count_if(here.begin(), here.end(), same) != 1) continue;
            const bool fold = std::count_if(here.begin(), here.end(), shares) > 1;
            const SnappedPoint a = mesh.corner(edge.triangle, edge.k), b = mesh.corner(edge.triangle, (edge.k + 1) % 3);
            if (crosses_canvas(a, b, mesh.canvas())) edges.push_back({edge.triangle, a, b, fold});
        }
    }
    drop_cuts(mesh, edges);
    return edges;
}

BorderPixels::BorderPixels(const Eigen::MatrixX3i& faces, const SnappedMesh& mesh, const std::vector<BorderEdge>& edges,
                           const Eigen::AlignedBox2d& frame) {
    if (edges.empty()) return;
    const Finder finder(faces, mesh, edges, frame);
    const int height = mesh.canvas().height;
    std::vector<std::vector<BorderPixel>> bands(static_cast<std::size_t>((height - 1) / band_rows + 1));
    parallel_for(0, height, band_rows, [&](int first, int last) {
        bands[static_cast<std::size_t>(first / band_rows)] = finder.pixels_in({first, last});
    });
    for (const std::vector<BorderPixel>& band : bands) pixels_.insert(pixels_.end(), band.begin(), band.end());
    std::sort(pixels_.begin(), pixels_.end(), [](const BorderPixel& a, const BorderPixel& b) {
        return std::tuple(a.triangle, a.row, a.x) < std::tuple(b.triangle, b.row, b.x);
    });
    starts_.assign(static_cast<std::size_t>(faces.rows()) + 1, 0);
    for (const BorderPixel& pixel : pixels_) ++starts_[static_cast<std::size_t>(pixel.triangle) + 1];
    for (std::size_t i = 1; i < starts_.size(); ++i) starts_[i] += starts_[i - 1];
}

std::span<const BorderPixel> BorderPixels::of(int triangle) const {
    if (empty()) return {};
    const auto i = static_cast<std::size_t>(triangle);
    return {pixels_.data() + starts_[i], starts_[i + 1] - starts_[i]};
}

}  // namespace puppetwarp::detail
