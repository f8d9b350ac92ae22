#include <puppetwarp/diff/flip.h>

#include <puppetwarp/base/threads.h>
#include <puppetwarp/diff/flip_colour.h>
#include <puppetwarp/diff/flip_filters.h>
#include <puppetwarp/diff/seen_rows.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <vector>

namespace puppetwarp {

namespace {

// A tile of the picture at a time: what it needs stays in the processor's cache.
constexpr int kTileColumns = 256;

// What all tiles need.
struct Model {
    FlipFilters filters;
    LinearLight light;
    ColourError colour_error;

    explicit Model(double pixels_per_degree) : filters(pixels_per_degree) {}
};

using ThreePlanes = std::array<Plane, 3>;

// What is compared of one picture.
struct Features {
    ThreePlanes lab;  // as the eye sees it, after Hunt
    Plane edges;      // strength
    Plane points;
};

// Opponent colours of both pictures in a tile and a margin around it. Beyond the border the picture's last pixel goes
// on.
class OpponentTile {
public:
    OpponentTile(const AlignedPair& pair, float background, const Model& model)
        : pair_(pair), model_(model), rows_(pair, background) {}

    void read(const cv::Rect& tile) {
        const int margin = model_.filters.reach;
        for (ThreePlanes* planes : {&expected, &actual}) {
            for (Plane& plane : *planes) plane.resize(tile.width + 2 * margin, tile.height + 2 * margin);
        }
        const int left = std::max(0, tile.x - margin);
        const int right = std::min(pair_.expected.cols, tile.x + tile.width + margin);
        for (int row = 0; row < tile.height + 2 * margin; ++row) {
            const int y = std::clamp(tile.y - margin + row, 0, pair_.expected.rows - 1);
            rows_.read(y, left, right);
            put(rows_.expected(), left - (tile.x - margin), row, expected);
            put(rows_.actual(), left - (tile.x - margin), row, actual);
        }
    }

    ThreePlanes expected;
    ThreePlanes actual;

private:
    // Puts a row of seen colours from `column` on, and carries its ends on to those of the planes.
    void put(const SeenRow& seen, int column, int row, ThreePlanes& planes) {
        for (int c = 0; c < seen.planes_count; ++c) {
            linear_[static_cast<std::size_t>(c)].resize(static_cast<std::size_t>(seen.width));
            const float* from = seen.plane(c);
            float* to = linear_[static_cast<std::size_t>(c)].data();
            for (int x = 0; x < seen.width; ++x) to[x] = model_.light.of(from[x]);
        }
        const float* red = linear_[0].data();
        const float* green = seen.planes_count == 3 ? linear_[1].data() : red;
        const float* blue = seen.planes_count == 3 ? linear_[2].data() : red;
        float* a = planes[0].row(row) + column;
        float* b = planes[1].row(row) + column;
        float* c = planes[2].row(row) + column;
        for (int x = 0; x < seen.width; ++x) {
            const Colour colour = ycxcz_from_linear({red[x], green[x], blue[x]});
            a[x] = colour.a;
            b[x] = colour.b;
            c[x] = colour.c;
        }
        for (Plane& plane : planes) {
            float* whole = plane.row(row);
            std::fill(whole, whole + column, whole[column]);
            std::fill(whole + column + seen.width, whole + plane.width, whole[column + seen.width - 1]);
        }
    }

    const AlignedPair& pair_;
    const Model& model_;
    SeenRows rows_;
    std::array<std::vector<float>, 3> linear_;
};

// From opponent colours to what is compared; keeps its buffers.
class FeatureFilter {
public:
    explicit FeatureFilter(const Model& model) : model_(model) {}

    void run(const ThreePlanes& opponent, Features& features) {
        see_colours(opponent, features.lab);
        see_features(opponent[0], features);
    }

private:
    void see_colours(const ThreePlanes& opponent, ThreePlanes& lab) {
        const FlipFilters& filters = model_.filters;
        filter(opponent[0], filters.reach, filters.achromatic, filters.achromatic, scratch_, lab[0]);
        filter(opponent[1], filters.reach, filters.red_green, filters.red_green, scratch_, lab[1]);
        filter(opponent[2], filters.reach, filters.blue_yellow[0], filters.blue_yellow[0], scratch_, lab[2]);
        filter(opponent[2], filters.reach, filters.blue_yellow[1], filters.blue_yellow[1], scratch_, second_);
        const float share = filters.blue_yellow_share[0], second_share = filters.blue_yellow_share[1];
        float* a = lab[0].values.data();
        float* b = lab[1].values.data();
        float* c = lab[2].values.data();
        const float* second = second_.values.data();
        for (std::size_t i = 0; i < lab[0].values.size(); ++i) {
            const Colour seen{a[i], b[i], share * c[i] + second_share * second[i]};
            const Colour colour = hunt_lab_from_linear(linear_from_ycxcz(seen));
            a[i] = colour.a;
            b[i] = colour.b;
            c[i] = colour.c;
        }
    }

    // Edges and points along x and along y, of which only the strength counts.
    void see_features(const Plane& achromatic, Features& features) {
        const FlipFilters& filters = model_.filters;
        filter_down(achromatic, filters.reach, filters.gauss, scratch_);
        filter_across(scratch_, filters.reach, filters.edge, features.edges);
        filter_across(scratch_, filters.reach, filters.point, features.points);
        filter(achromatic, filters.reach, filters.edge, filters.gauss, scratch_, second_);
        to_strength(second_, features.edges);
        filter(achromatic, filters.reach, filters.point, filters.gauss, scratch_, second_);
        to_strength(second_, features.points);
    }

    // Achromatic values are 116 Y - 16; the paper's are Y, and a derivative knows no offset.
    static void to_strength(const Plane& along_y, Plane& along_x) {
        const float* y = along_y.values.data();
        float* x = along_x.values.data();
        for (std::size_t i = 0; i < along_x.values.size(); ++i) {
            x[i] = std::sqrt(x[i] * x[i] + y[i] * y[i]) * (1 / 116.0F);
        }
    }

    const Model& model_;
    Plane scratch_;
    Plane second_;
};

void errors_between(const Features& expected, const Features& actual, const ColourError& colour_error,
                    std::vector<float>& errors) {
    errors.resize(expected.edges.values.size());
    const float *a = expected.lab[0].values.data(), *b = expected.lab[1].values.data(),
                *c = expected.lab[2].values.data();
    const float *p = actual.lab[0].values.data(), *q = actual.lab[1].values.data(), *r = actual.lab[2].values.data();
    const float *edges = expected.edges.values.data(), *other_edges = actual.edges.values.data();
    const float *points = expected.points.values.data(), *other_points = actual.points.values.data();
    float* error = errors.data();
    for (std::size_t i = 0; i < errors.size(); ++i) {
        const float colour = colour_error.of(hyab({a[i], b[i], c[i]}, {p[i], q[i], r[i]}));
        error[i] = flip_error(colour, std::abs(edges[i] - other_edges[i]), std::abs(points[i] - other_points[i]));
    }
}

// Whether both pictures have the same bytes in a tile and the margin around it: then no error can come out.
bool is_equal(const AlignedPair& pair, const cv::Rect& tile, int margin) {
    if (pair.expected.type() != pair.actual.type()) return false;
    const cv::Rect wide(tile.x - margin, tile.y - margin, tile.width + 2 * margin, tile.height + 2 * margin);
    const cv::Rect inside = wide & cv::Rect(0, 0, pair.expected.cols, pair.expected.rows);
    const std::size_t bytes = static_cast<std::size_t>(inside.width) * pair.expected.elemSize();
    for (int y = inside.y; y < inside.y + inside.height; ++y) {
        if (std::memcmp(pair.expected.ptr(y, inside.x), pair.actual.ptr(y, inside.x), bytes) != 0) return false;
    }
    return true;
}

// The errors of a tile as seen over one background.
class TileErrors {
public:
    TileErrors(const AlignedPair& pair, float background, const Model& model)
        : model_(model), opponent_(pair, background, model), filter_(model) {}

    const std::vector<float>& of(const cv::Rect& tile) {
        opponent_.read(tile);
        filter_.run(opponent_.expected, expected_);
        filter_.run(opponent_.actual, actual_);
        errors_between(expected_, actual_, model_.colour_error, errors_);
        return errors_;
    }

private:
    const Model& model_;
    OpponentTile opponent_;
    FeatureFilter filter_;
    Features expected_;
    Features actual_;
    std::vector<float> errors_;
};

struct BandFigures {
    double sum = 0;
    float max = 0;
    int max_x = -1, max_y = -1;

    // Tiles come one beside the other, so that of equal errors the first in reading order must be sought.
    void add(float error, int x, int y) {
        sum += error;
        if (error < max || error == 0) return;
        if (error == max && (y > max_y || (y == max_y && x > max_x))) return;
        max = error;
        max_x = x;
        max_y = y;
    }
};

class BandOfTiles {
public:
    BandOfTiles(const AlignedPair& pair, const std::vector<float>& backgrounds, const Model& model, double threshold)
        : pair_(pair), margin_(model.filters.reach), threshold_(threshold) {
        seen_.reserve(backgrounds.size());
        for (const float background : backgrounds) seen_.emplace_back(pair, background, model);
    }

    BandFigures run(int first, int last, cv::Mat& marks, cv::Mat* errors) {
        BandFigures figures;
        for (int x = 0; x < pair_.expected.cols; x += kTileColumns) {
            const cv::Rect tile(x, first, std::min(kTileColumns, pair_.expected.cols - x), last - first);
            if (is_equal(pair_, tile, margin_)) continue;
            worst_ = seen_.front().of(tile);
            for (std::size_t i = 1; i < seen_.size(); ++i) {
                const std::vector<float>& other = seen_[i].of(tile);
                for (std::size_t k = 0; k < worst_.size(); ++k) worst_[k] = std::max(worst_[k], other[k]);
            }
            for (int y = 0; y < tile.height; ++y) {
                take_row(worst_.data() + static_cast<std::ptrdiff_t>(y) * tile.width, tile, tile.y + y, figures, marks,
                         errors);
            }
        }
        return figures;
    }

private:
    void take_row(const float* row, const cv::Rect& tile, int y, BandFigures& figures, cv::Mat& marks,
                  cv::Mat* errors) const {
        const std::uint8_t* selected = pair_.selected_row(y);
        std::uint8_t* mark = marks.ptr(y);
        for (int x = tile.x; x < tile.x + tile.width; ++x) {
            if (selected && !selected[x]) continue;
            const float error = row[x - tile.x];
            figures.add(error, x, y);
            if (error > threshold_) mark[x] |= kOver;
            if (errors) errors->at<float>(y, x) = error;
        }
    }

    const AlignedPair& pair_;
    int margin_;
    double threshold_;
    std::vector<TileErrors> seen_;
    std::vector<float> worst_;
};

}  // namespace

FlipFigures flip(const AlignedPair& pair, double pixels_per_degree, double threshold, cv::Mat& marks, cv::Mat* errors) {
    const Model model(pixels_per_degree);
    const std::vector<float> backgrounds = backgrounds_of(pair);
    const int rows = pair.expected.rows;
    std::vector<BandFigures> bands(static_cast<std::size_t>((rows + kBandRows - 1) / kBandRows));
    parallel_for(0, rows, kBandRows, [&](int first, int last) {
        bands[static_cast<std::size_t>(first / kBandRows)] =
            BandOfTiles(pair, backgrounds, model, threshold).run(first, last, marks, errors);
    });
    BandFigures all;
    for (const BandFigures& band : bands) {
        all.sum += band.sum;
        if (band.max <= all.max) continue;
        all.max = band.max;
        all.max_x = band.max_x;
        all.max_y = band.max_y;
    }
    return {all.sum / static_cast<double>(pair.selected_pixels), all.max, all.max_x, all.max_y};
}

}  // namespace puppetwarp
