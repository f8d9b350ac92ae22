#include <puppetwarp/mesh/offset_field.h>

#include <puppetwarp/base/threads.h>

#include <algorithm>
#include <cmath>

namespace puppetwarp {

namespace {

constexpr int band_rows = 64;  // rows of the field that one thread works on

struct RowCrossing {
    int row;
    double x;
    int winding;
};

// Where the polygons cross the lines of nodes, sorted by row and x.
std::vector<RowCrossing> row_crossings(const ContourField& field, const std::vector<GrownPolygon>& silhouette) {
    std::vector<RowCrossing> crossings;
    for (const GrownPolygon& polygon : silhouette) {
        for (std::size_t k = 0; k < polygon.points.size(); ++k) {
            const Point& a = polygon.points[k];
            const Point& b = polygon.points[(k + 1) % polygon.points.size()];
            const double ya = a.y() - field.y0(), yb = b.y() - field.y0();
            const int first = std::max(0, static_cast<int>(std::ceil(std::min(ya, yb))));
            const int end = std::min(field.rows(), static_cast<int>(std::ceil(std::max(ya, yb))));
            for (int row = first; row < end; ++row) {
                const double x = a.x() - field.x0() + (b.x() - a.x()) * ((row - ya) / (yb - ya));
                crossings.push_back({row, x, yb > ya ? 1 : -1});
            }
        }
    }
    std::sort(crossings.begin(), crossings.end(), [](const RowCrossing& a, const RowCrossing& b) {
        return a.row != b.row ? a.row < b.row : a.x != b.x ? a.x < b.x : a.winding < b.winding;
    });
    return crossings;
}

void fill_inside(ContourField& field, const std::vector<GrownPolygon>& silhouette) {
    const std::vector<RowCrossing> crossings = row_crossings(field, silhouette);
    int winding = 0;
    for (std::size_t k = 0; k + 1 < crossings.size(); ++k) {
        const RowCrossing& here = crossings[k];
        const RowCrossing& next = crossings[k + 1];
        winding += here.winding;
        if (here.row != next.row) winding = 0;
        // Boundaries of positive area go up on their left side: inside, the winding number is negative.
        if (winding >= 0) continue;
        const int first = std::max(1, static_cast<int>(std::ceil(here.x)));
        const int end = std::min(field.columns() - 1, static_cast<int>(std::ceil(next.x)));
        if (first < end) std::fill(field.row(here.row) + first, field.row(here.row) + end, std::int8_t{127});
    }
}

struct Piece {
    Point a, b;
    double radius_a, radius_b;
};

// Edges cut to lengths whose surroundings are worth searching, in the field's coordinates from its first node.
std::vector<Piece> pieces_of(const ContourField& field, const std::vector<GrownPolygon>& silhouette) {
    std::vector<Piece> pieces;
    const Point origin(field.x0(), field.y0());
    for (const GrownPolygon& polygon : silhouette) {
        for (std::size_t k = 0; k < polygon.points.size(); ++k) {
            const std::size_t next = (k + 1) % polygon.points.size();
            const Point a = polygon.points[k] - origin, b = polygon.points[next] - origin;
            const double ra = polygon.radii[k], rb = polygon.radii[next];
            const int parts = std::max(1, static_cast<int>(std::ceil((b - a).norm() / std::max(8.0, ra))));
            for (int part = 0; part < parts; ++part) {
                const double s = static_cast<double>(part) / parts, t = static_cast<double>(part + 1) / parts;
                pieces.push_back({a + s * (b - a), a + t * (b - a), ra + s * (rb - ra), ra + t * (rb - ra)});
            }
        }
    }
    return pieces;
}

std::int8_t stored(double distance) {
    const double scaled = distance * ContourField::scale;
    if (scaled >= 0) return static_cast<std::int8_t>(std::clamp(scaled + 0.5, 1.0, 127.0));
    return static_cast<std::int8_t>(std::clamp(scaled - 0.5, -127.0, -1.0));
}

// Lets one piece act on the nodes near it in rows [first, last). Inwards: nodes inside learn how near the boundary
// is; outwards: nodes outside learn how far the grown piece covers them.
template <bool inwards>
void stamp(ContourField& field, const Piece& piece, int first, int last) {
    const double radius = std::max(piece.radius_a, piece.radius_b);
    const double reach = inwards ? 1.0 : radius + 1;
    const Point edge = piece.b - piece.a;
    const double inverse = edge.squaredNorm() > 0 ? 1 / edge.squaredNorm() : 0;
    const auto from = [&](double a, double b, int lowest) {
        return std::max(lowest, static_cast<int>(std::ceil(std::min(a, b) - reach)));
    };
    const auto to = [&](double a, double b, int end) {
        return std::min(end, static_cast<int>(std::floor(std::max(a, b) + reach)) + 1);
    };
    const int left = from(piece.a.x(), piece.b.x(), 1), right = to(piece.a.x(), piece.b.x(), field.columns() - 1);
    const int bottom = to(piece.a.y(), piece.b.y(), last);
    for (int j = from(piece.a.y(), piece.b.y(), first); j < bottom; ++j) {
        std::int8_t* row = field.row(j);
        for (int i = left; i < right; ++i) {
            if (inwards ? row[i] <= 0 : row[i] == 127) continue;
            const double dx = i - piece.a.x(), dy = j - piece.a.y();
            const double t = std::clamp((dx * edge.x() + dy * edge.y()) * inverse, 0.0, 1.0);
            const double ex = dx - t * edge.x(), ey = dy - t * edge.y();
            const double squared = ex * ex + ey * ey;
            if (squared >= reach * reach) continue;
            const double grown = piece.radius_a + t * (piece.radius_b - piece.radius_a);
            if (inwards) {
                row[i] = std::min(row[i], stored(grown + std::sqrt(squared)));
            } else {
                row[i] = std::max(ContourField::value(row[i]), stored(grown - std::sqrt(squared)));
            }
        }
    }
}

template <bool inwards>
void stamp_all(ContourField& field, const std::vector<Piece>& pieces) {
    const int bands = (field.rows() + band_rows - 1) / band_rows;
    std::vector<std::vector<std::size_t>> of_band(static_cast<std::size_t>(bands));
    for (std::size_t k = 0; k < pieces.size(); ++k) {
        const Piece& piece = pieces[k];
        const double reach = std::max(piece.radius_a, piece.radius_b) + 1;
        const double top = std::min(piece.a.y(), piece.b.y()) - reach;
        const double bottom = std::max(piece.a.y(), piece.b.y()) + reach;
        const int first = std::max(0, static_cast<int>(std::floor(top / band_rows)));
        const int last = std::min(bands - 1, static_cast<int>(std::floor(bottom / band_rows)));
        for (int band = first; band <= last; ++band) of_band[static_cast<std::size_t>(band)].push_back(k);
    }
    parallel_for(0, bands, 1, [&](int first, int last) {
        for (int band = first; band < last; ++band) {
            const int top = std::max(1, band * band_rows);
            const int bottom = std::min(field.rows() - 1, (band + 1) * band_rows);
            for (const std::size_t k : of_band[static_cast<std::size_t>(band)]) {
                stamp<inwards>(field, pieces[k], top, bottom);
            }
        }
    });
}

// How far the squares of covered pixels beside `point` reach out along `normal`.
double reach_of_support(const MatteReader& matte, const Point& point, const Point& normal) {
    const Point beyond = point + 3 * normal;
    // Where coverage goes on, its own boundary is elsewhere.
    if (matte.covered(static_cast<int>(std::floor(beyond.x())), static_cast<int>(std::floor(beyond.y())))) return 0;
    const int x = static_cast<int>(std::floor(point.x())), y = static_cast<int>(std::floor(point.y()));
    double needed = 0;
    for (int j = y - 2; j <= y + 2; ++j) {
        for (int i = x - 2; i <= x + 2; ++i) {
            if (!matte.covered(i, j)) continue;
            const Point out = Point(i + (normal.x() > 0 ? 1 : 0), j + (normal.y() > 0 ? 1 : 0)) - point;
            const double along = std::abs(out.x() * normal.y() - out.y() * normal.x());
            const double distance = out.dot(normal);
            if (along <= 0.75 && distance <= 2) needed = std::max(needed, distance);
        }
    }
    return needed;
}

// Samples about every pixel, with corners kept.
Polyline sampled(const Polyline& polygon) {
    Polyline samples;
    for (std::size_t k = 0; k < polygon.size(); ++k) {
        const Point& a = polygon[k];
        const Point& b = polygon[(k + 1) % polygon.size()];
        const int parts = std::max(1, static_cast<int>((b - a).norm()));
        for (int part = 0; part < parts; ++part) samples.push_back(a + (b - a) * (static_cast<double>(part) / parts));
    }
    return samples;
}

// Raises radii so that they change slowly: growth must not make stairs of its own.
void smooth_upwards(std::vector<double>& radii) {
    const std::size_t count = radii.size();
    constexpr double slope = 0.01;  // pixels per sample, that is per pixel
    for (std::size_t k = 1; k < 2 * count; ++k) {
        radii[k % count] = std::max(radii[k % count], radii[(k - 1) % count] - slope);
    }
    for (std::size_t k = 2 * count - 1; k > 0; --k) {
        radii[(k - 1) % count] = std::max(radii[(k - 1) % count], radii[k % count] - slope);
    }
}

}  // namespace

void fill_offset(ContourField& field, const std::vector<GrownPolygon>& silhouette) {
    fill_inside(field, silhouette);
    const std::vector<Piece> pieces = pieces_of(field, silhouette);
    const bool close = std::any_of(pieces.begin(), pieces.end(),
                                   [](const Piece& piece) { return std::min(piece.radius_a, piece.radius_b) < 1; });
    if (close) stamp_all<true>(field, pieces);  // else every node inside is at least 1 deep
    stamp_all<false>(field, pieces);
}

void unite(ContourField& field, const ContourField& other) {
    const int column = static_cast<int>(other.x0() - field.x0()), first_row = static_cast<int>(other.y0() - field.y0());
    for (int j = 0; j < other.rows(); ++j) {
        std::int8_t* row = field.row(first_row + j) + column;
        const std::int8_t* more = other.row(j);
        for (int i = 0; i < other.columns(); ++i) {
            if (more[i] != 0) row[i] = std::max(ContourField::value(row[i]), more[i]);
        }
    }
}

std::vector<GrownPolygon> radii_for_support(const std::vector<Polyline>& silhouette, const MatteReader& matte,
                                            double margin) {
    std::vector<GrownPolygon> grown(silhouette.size());
    parallel_for(0, static_cast<int>(silhouette.size()), 16, [&](int first, int last) {
        for (int index = first; index < last; ++index) {
            GrownPolygon& polygon = grown[static_cast<std::size_t>(index)];
            polygon.points = sampled(silhouette[static_cast<std::size_t>(index)]);
            const std::size_t count = polygon.points.size();
            for (std::size_t k = 0; k < count; ++k) {
                const Point along = polygon.points[(k + 1) % count] - polygon.points[(k + count - 1) % count];
                const double length = along.norm();
                // The inside is on the right, seen on screen.
                const Point normal = length > 0 ? Point(along.y() / length, -along.x() / length) : Point(0, 0);
                polygon.radii.push_back(margin + reach_of_support(matte, polygon.points[k], normal));
            }
            smooth_upwards(polygon.radii);
        }
    });
    return grown;
}

}  // namespace puppetwarp
