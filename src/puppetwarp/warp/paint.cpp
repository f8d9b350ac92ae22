#include <puppetwarp/warp/paint.h>

#include <puppetwarp/base/threads.h>
#include <puppetwarp/warp/coverage_bits.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

namespace puppetwarp::detail {

namespace {

constexpr int longest_run = 256;

// So many rows of source and output at a time stay in the second cache.
constexpr int strip_rows = 8;
constexpr std::size_t usual_spans = 2048;  // of a strip of a large picture

// Levels that triangles need, and the box around these triangles at rest.
struct Needed {
    int levels = 0;
    Eigen::RowVector2d low = Eigen::RowVector2d::Constant(std::numeric_limits<double>::max());
    Eigen::RowVector2d high = -low;

    void add(const TriangleMesh& rest, int triangle, int level) {
        levels = std::max(levels, level);
        for (int k = 0; k < 3; ++k) {
            low = low.cwiseMin(rest.V.row(rest.F(triangle, k)));
            high = high.cwiseMax(rest.V.row(rest.F(triangle, k)));
        }
    }
    void add(const Needed& other) {
        levels = std::max(levels, other.levels);
        low = low.cwiseMin(other.low);
        high = high.cwiseMax(other.high);
    }
};

}  // namespace

// How a triangle's pixels are made.
struct Painter::Part {
    FaceMap map;
    Footprint footprint;
    bool simple = false;  // one sample a pixel, all taps inside
};

// Some rows, and what is painted there, in the order of the triangles.
struct Painter::Strip {
    RowRange rows;
    std::vector<Span> spans;  // `inside` with positions, `border` with the pixel's index for u
    CoverageBits covered;     // kept for outputs with alpha only
    bool overlaps = false;
};

struct Painter::Plan {
    RowRange band;
    std::vector<Part> parts;
    std::vector<Steps> steps;
    std::vector<BorderPixel> border;
    std::vector<Strip> strips;

    Strip& strip(int row) { return strips[static_cast<std::size_t>((row - band.first) / strip_rows)]; }
};

Painter::Painter(const Paint& paint, const TriangleMesh& rest, const Eigen::MatrixX2d& moved, const Layout& layout,
                 const WarpOptions& options, Simd simd)
    : format_(paint.format),
      rest_(rest),
      moved_(moved),
      mesh_(layout.mesh),
      border_(layout.border),
      counts_layers_(format_.out_has_alpha() && !layout.one_layer),
      canvas_(options.canvas),
      interpolation_(options.interpolation),
      samplers_(find_samplers(format_, options.interpolation, paint.light != nullptr, simd)),
      single_(source_of(paint.pixels, format_, paint.light), samplers_.single),
      several_(single_.source, samplers_.several),
      ops_(find_pixel_ops(format_)) {
    find_levels(simd);
}

// The levels that some triangle needs, of the part of the picture where it needs them.
void Painter::find_levels(Simd simd) {
    const int highest = highest_level(single_.source.width, single_.source.height);
    constexpr int block = 1024;
    std::vector<Needed> needed(static_cast<std::size_t>(mesh_.triangle_count() / block + 1));
    parallel_for(0, mesh_.triangle_count(), block, [&](int first, int last) {
        for (int triangle = first; triangle < last; ++triangle) {
            const RowRange rows = mesh_.rows(triangle);
            if (rows.first >= rows.last) continue;
            const int level = footprint(linear_part(rest_, moved_, triangle), interpolation_, highest).level;
            if (level > 0) needed[static_cast<std::size_t>(first / block)].add(rest_, triangle, level);
        }
    });
    for (const Needed& some : needed) needed.front().add(some);
    const auto [levels, low, high] = needed.front();
    if (levels == 0) return;
    const auto pixel = [](double x, int size) {
        return static_cast<int>(std::clamp<double>(std::floor(x), 0, size - 1));
    };
    const Source& source = single_.source;
    const PixelBox box{pixel(low.x(), source.width), pixel(low.y(), source.height), pixel(high.x(), source.width) + 1,
                       pixel(high.y(), source.height) + 1};
    pyramid_ = Pyramid(source, samplers_.read, box, levels);
    for (int level = 1; level <= levels; ++level) {
        levels_.emplace_back(pyramid_.level(level), level_sampler(source.channels, interpolation_, simd),
                             pyramid_.frame(level));
    }
}

// From what a triangle reads to what it reads a strip further down: the memory is asked for in time.
std::ptrdiff_t Painter::bytes_ahead(const FaceMap& map) const {
    const auto steps = [&](int axis) {
        return std::llround(std::clamp(strip_rows * map.jacobian()(axis, 1), -1000.0, 1000.0));
    };
    return static_cast<std::ptrdiff_t>(steps(1)) * static_cast<std::ptrdiff_t>(single_.source.step) +
           static_cast<std::ptrdiff_t>(steps(0)) * static_cast<std::ptrdiff_t>(format_.source_bytes());
}

// The place of a border pixel's sample: its centre, or the nearest point of its triangle.
Eigen::Vector2d Painter::sampled_centre(const BorderPixel& pixel) const {
    Eigen::Vector2d centre(centre_x(pixel.x), centre_y(pixel.row));
    if (pixel.holds_centre) return centre;
    Eigen::Vector2d nearest = centre;
    double least = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 3; ++k) {
        const Eigen::Vector2d a = moved_.row(rest_.F(pixel.triangle, k));
        const Eigen::Vector2d ab = moved_.row(rest_.F(pixel.triangle, (k + 1) % 3)).transpose() - a;
        const double length = ab.squaredNorm();
        const double t = length > 0 ? std::clamp((centre - a).dot(ab) / length, 0.0, 1.0) : 0;
        const Eigen::Vector2d p = a + t * ab;
        if ((centre - p).squaredNorm() >= least) continue;
        least = (centre - p).squaredNorm();
        nearest = p;
    }
    return nearest;
}

const SampledView& Painter::view_of(const Footprint& shape) const {
    if (shape.level > 0) return levels_[static_cast<std::size_t>(shape.level) - 1];
    return shape.samples() == 1 ? single_ : several_;
}

// Several samples: with the triangle's map also where a pixel's square reaches over its edges.
void Painter::sample(const Part& part, double x, double y, const Batch::Target& target, Batch& batch) const {
    const Footprint& shape = part.footprint;
    const SampledView& view = view_of(shape);
    const int samples = shape.samples();
    const int longest = Batch::capacity / samples;
    std::array<Run, most_samples> runs;
    for (int done = 0; done < target.count; done += longest) {
        const int count = std::min(longest, target.count - done);
        for (int k = 0; k < samples; ++k) {
            const Eigen::Vector2d at = Eigen::Vector2d(x + done, y) + shape.offset_px(k);
            runs[static_cast<std::size_t>(k)] = shape.level == 0 ? part.map.run(at.x(), at.y(), count)
                                                                 : part.map.run_in(view.frame, at.x(), at.y(), count);
        }
        batch.sample(view, {target.row, target.first + done, count, target.coverage}, runs.data(), samples);
    }
}

void Painter::paint_span(const Plan& plan, const Span& span, Batch& batch) const {
    const Part& part = plan.parts[static_cast<std::size_t>(span.steps)];
    Batch::Target target{span.row, span.first, span.count};
    if (span.kind == Span::Kind::border) {
        const BorderPixel& pixel = plan.border[static_cast<std::size_t>(span.u)];
        const Eigen::Vector2d centre = sampled_centre(pixel);
        target.coverage = pixel.coverage;
        sample(part, centre.x(), centre.y(), target, batch);
    } else if (part.map.is_copy()) {
        // In 64 bits: triangles far away have long shifts.
        const std::int64_t x = std::int64_t{span.first} + canvas_.x - part.map.shift().x();
        const std::int64_t y = std::int64_t{span.row} + canvas_.y - part.map.shift().y();
        batch.copy(target, x, y);
    } else {
        sample(part, centre_x(span.first), centre_y(span.row), target, batch);
    }
}

Painter::Part Painter::part_of(int triangle) const {
    const FaceMap map(rest_, moved_, triangle);
    Part part{map, footprint(map.jacobian(), interpolation_, pyramid_.top_level())};
    part.simple = !map.is_copy() && part.footprint.level == 0 && part.footprint.samples() == 1 && single_.holds(map);
    return part;
}

void Painter::add_span(const Part& part, int row, int first, int last, Plan& plan) const {
    Strip& strip = plan.strip(row);
    if (counts_layers_ && first < last) strip.overlaps |= strip.covered.add(row, first, last);
    const int steps = static_cast<int>(plan.steps.size()) - 1;
    for (int x = first; x < last; x += longest_run) {
        const auto count = static_cast<std::int16_t>(std::min(longest_run, last - x));
        if (part.simple) {
            const Run run = part.map.run(centre_x(x), centre_y(row), count);
            const std::int64_t shift = single_.sampler.shift;
            strip.spans.push_back({run.u + shift, run.v + shift, steps, row, x, count, Span::Kind::inside});
        } else {
            strip.spans.push_back({0, 0, steps, row, x, count, Span::Kind::anywhere});
        }
    }
}

void Painter::add_border(const BorderPixel& pixel, Plan& plan) const {
    Strip& strip = plan.strip(pixel.row);
    strip.overlaps |= strip.covered.add(pixel.row, pixel.x, pixel.x + 1);
    const int steps = static_cast<int>(plan.steps.size()) - 1;
    strip.spans.push_back(
        {static_cast<std::int64_t>(plan.border.size()), 0, steps, pixel.row, pixel.x, 1, Span::Kind::border});
    plan.border.push_back(pixel);
}

void Painter::add_triangle(int triangle, Plan& plan) const {
    const Part part = part_of(triangle);
    plan.parts.push_back(part);
    plan.steps.push_back(part.map.steps());
    plan.steps.back().ahead = bytes_ahead(part.map);
    const std::span<const BorderPixel> border = border_.of(triangle);
    // What is copied stays as it is, up to the last pixel, but for folds.
    const auto stays = [&](const BorderPixel& pixel) { return part.map.is_copy() && !pixel.at_fold; };
    mesh_.for_each_span_of(triangle, plan.band, [&](int row, int first, int last) {
        for (const BorderPixel& pixel : border) {
            if (pixel.row != row || !pixel.holds_centre || stays(pixel)) continue;
            add_span(part, row, first, pixel.x, plan);
            add_border(pixel, plan);
            first = pixel.x + 1;
        }
        add_span(part, row, first, last, plan);
    });
    for (const BorderPixel& pixel : border) {
        const bool in_band = pixel.row >= plan.band.first && pixel.row < plan.band.last;
        if (!pixel.holds_centre && in_band && !stays(pixel)) add_border(pixel, plan);
    }
}

Painter::Plan Painter::planned(RowRange band) const {
    Plan plan;
    plan.band = band;
    for (int row = band.first; row < band.last; row += strip_rows) {
        const RowRange rows{row, std::min(row + strip_rows, band.last)};
        plan.strips.push_back({rows, {}, CoverageBits(rows, counts_layers_ ? canvas_.width : 0)});
        plan.strips.back().spans.reserve(usual_spans);
    }
    mesh_.for_each_triangle_in(band, [&](int triangle) { add_triangle(triangle, plan); });
    return plan;
}

// Where one span lies over another everything is blended with what is there; else each pixel is written once.
void Painter::clear(const Strip& strip, const CanvasRows& out) const {
    const auto clear_pixels = [&](int row, int first, int last) {
        std::memset(out.row(row) + format_.out_bytes() * static_cast<std::size_t>(first), 0,
                    format_.out_bytes() * static_cast<std::size_t>(last - first));
    };
    for (int row = strip.rows.first; row < strip.rows.last; ++row) {
        if (strip.overlaps) {
            clear_pixels(row, 0, canvas_.width);
        } else {
            strip.covered.for_each_gap(row, [&](int first, int last) { clear_pixels(row, first, last); });
        }
    }
}

void Painter::paint_strip(const Plan& plan, const Strip& strip, Batch& batch) const {
    batch.expect_overlaps(strip.overlaps);
    const std::vector<Span>& spans = strip.spans;
    for (std::size_t i = 0; i < spans.size();) {
        std::size_t end = i;
        int pixels = 0;
        while (end < spans.size() && spans[end].kind == Span::Kind::inside &&
               pixels + spans[end].count <= Batch::capacity) {
            pixels += spans[end++].count;
        }
        if (end == i) {
            paint_span(plan, spans[end++], batch);
        } else {
            batch.sample_inside(single_, &spans[i], static_cast<int>(end - i), pixels, plan.steps.data());
        }
        i = end;
    }
    batch.flush();
}

void Painter::paint(RowRange band, const CanvasRows& out) const {
    const Plan plan = planned(band);
    Batch batch(format_, ops_, samplers_.store, single_.source, out);
    for (const Strip& strip : plan.strips) {
        if (counts_layers_) clear(strip, out);
        paint_strip(plan, strip, batch);
    }
}

}  // namespace puppetwarp::detail
