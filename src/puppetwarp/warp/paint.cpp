#include <puppetwarp/warp/paint.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <vector>

namespace puppetwarp::detail {

namespace {

constexpr int longest_run = 256;

// So many rows of source and output at a time stay in the second cache.
constexpr int strip_rows = 8;

Source source_of(const cv::Mat& pixels, const PixelFormat& format) {
    Source source;
    source.data = pixels.data;
    source.step = pixels.step[0];
    source.width = pixels.cols;
    source.height = pixels.rows;
    source.channels = format.channels;
    source.channel_bytes = format.channel_bytes();
    source.adds_alpha = format.adds_alpha;
    return source;
}

}  // namespace

// How a triangle's pixels are made.
struct Painter::Part {
    FaceMap map;
    Footprint footprint;
    bool simple = false;  // one sample a pixel, all taps inside
};

// The spans of a band's triangles, strip by strip; in each strip in the order of the triangles. Those of simple parts
// have their positions.
struct Painter::Plan {
    RowRange band;
    std::vector<Part> parts;
    std::vector<Steps> steps;
    std::vector<std::vector<Span>> strips;

    RowRange rows(std::size_t strip) const {
        const int first = band.first + strip_rows * static_cast<int>(strip);
        return {first, std::min(first + strip_rows, band.last)};
    }
};

Painter::Painter(const cv::Mat& pixels, const PixelFormat& format, const TriangleMesh& rest,
                 const Eigen::MatrixX2d& moved, const SnappedMesh& spans, const WarpOptions& options, Simd simd,
                 cv::Mat& out)
    : format_(format),
      rest_(rest),
      moved_(moved),
      spans_(spans),
      canvas_(options.canvas),
      interpolation_(options.interpolation),
      samplers_(find_samplers(format, options.interpolation, false, simd)),
      single_(source_of(pixels, format), samplers_.single),
      several_(single_.source, samplers_.several),
      ops_(find_pixel_ops(format)),
      out_(out) {}

// From what a triangle reads to what it reads a strip further down: the memory is asked for in time.
std::ptrdiff_t Painter::bytes_ahead(const FaceMap& map) const {
    const auto steps = [&](int axis) {
        return std::llround(std::clamp(strip_rows * map.jacobian()(axis, 1), -1000.0, 1000.0));
    };
    return static_cast<std::ptrdiff_t>(steps(1)) * static_cast<std::ptrdiff_t>(single_.source.step) +
           static_cast<std::ptrdiff_t>(steps(0)) * static_cast<std::ptrdiff_t>(format_.source_bytes());
}

void Painter::copy_span(const Part& part, const Span& span, Batch& batch) const {
    // In 64 bits: triangles far away have long shifts.
    const std::int64_t shift_x = std::int64_t{part.map.shift().x()} - canvas_.x;
    const std::int64_t shift_y = std::int64_t{part.map.shift().y()} - canvas_.y;
    batch.copy({span.row, span.first, span.count}, span.first - shift_x, span.row - shift_y);
}

void Painter::sample_span(const Part& part, const Span& span, Batch& batch) const {
    const Run run = part.map.run(centre_x(span.first), centre_y(span.row), span.count);
    batch.sample(single_, {span.row, span.first, span.count}, &run, 1);
}

// With the triangle's map also where a pixel's square reaches over its edges.
void Painter::supersample_span(const Part& part, const Span& span, Batch& batch) const {
    const Footprint& shape = part.footprint;
    constexpr int longest = Batch::capacity / most_samples;
    std::array<Run, most_samples> runs;
    for (int done = 0; done < span.count; done += longest) {
        const int count = std::min(longest, span.count - done), x = span.first + done;
        for (int k = 0; k < shape.samples(); ++k) {
            const double i = k % shape.nx - 0.5 * (shape.nx - 1), j = k / shape.nx - 0.5 * (shape.ny - 1);
            runs[static_cast<std::size_t>(k)] =
                part.map.run(centre_x(x) + i * shape.dx_px, centre_y(span.row) + j * shape.dy_px, count);
        }
        batch.sample(several_, {span.row, x, count}, runs.data(), shape.samples());
    }
}

void Painter::paint_span(const Part& part, const Span& span, Batch& batch) const {
    if (part.map.is_copy()) {
        copy_span(part, span, batch);
    } else if (part.footprint.samples() == 1) {
        sample_span(part, span, batch);
    } else {
        supersample_span(part, span, batch);
    }
}

Painter::Part Painter::part_of(int triangle) const {
    const FaceMap map(rest_, moved_, triangle);
    Part part{map, footprint(map.jacobian(), interpolation_, 0)};
    part.simple = !map.is_copy() && part.footprint.samples() == 1 && single_.holds(map);
    return part;
}

void Painter::add_spans(int triangle, RowRange band, Plan& plan) const {
    const int index = static_cast<int>(plan.parts.size());
    const Part part = part_of(triangle);
    plan.parts.push_back(part);
    plan.steps.push_back(part.map.steps());
    plan.steps.back().ahead = bytes_ahead(part.map);
    const std::int64_t shift = single_.sampler.shift;
    spans_.for_each_span_of(triangle, band, [&](int row, int first, int last) {
        std::vector<Span>& strip = plan.strips[static_cast<std::size_t>((row - band.first) / strip_rows)];
        for (int x = first; x < last; x += longest_run) {
            const int count = std::min(longest_run, last - x);
            Span span{0, 0, count, index, row, x};
            if (part.simple) {
                const Run run = part.map.run(centre_x(x), centre_y(row), count);
                span.u = run.u + shift;
                span.v = run.v + shift;
            }
            strip.push_back(span);
        }
    });
}

Painter::Plan Painter::planned(RowRange band) const {
    Plan plan;
    plan.band = band;
    plan.strips.resize(static_cast<std::size_t>(band.last - band.first - 1) / strip_rows + 1);
    spans_.for_each_triangle_in(band, [&](int triangle) { add_spans(triangle, band, plan); });
    return plan;
}

void Painter::clear(RowRange rows) const {
    for (int row = rows.first; row < rows.last; ++row) {
        std::memset(out_.ptr(row), 0, format_.out_bytes() * static_cast<std::size_t>(canvas_.width));
    }
}

void Painter::paint_strip(const Plan& plan, std::size_t strip, Batch& batch) const {
    if (format_.out_has_alpha()) clear(plan.rows(strip));
    const std::vector<Span>& spans = plan.strips[strip];
    const auto part = [&](std::size_t i) -> const Part& {
        return plan.parts[static_cast<std::size_t>(spans[i].steps)];
    };
    for (std::size_t i = 0; i < spans.size();) {
        if (!part(i).simple) {
            paint_span(part(i), spans[i], batch);
            ++i;
            continue;
        }
        std::size_t end = i;
        int pixels = 0;
        while (end < spans.size() && part(end).simple && pixels + spans[end].count <= Batch::capacity) {
            pixels += spans[end++].count;
        }
        batch.sample_inside(single_, &spans[i], static_cast<int>(end - i), plan.steps.data());
        i = end;
    }
    batch.flush();
}

void Painter::paint(RowRange band) const {
    const Plan plan = planned(band);
    Batch batch(format_, ops_, samplers_.store, single_.source, out_);
    for (std::size_t strip = 0; strip < plan.strips.size(); ++strip) paint_strip(plan, strip, batch);
}

}  // namespace puppetwarp::detail
