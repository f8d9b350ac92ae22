#include <puppetwarp/warp/paint.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <vector>

namespace puppetwarp::detail {

namespace {

constexpr int longest_run = 256;  // short enough for the buffers to stay in the first cache
constexpr std::size_t largest_pixel = 4 * sizeof(float);

// So many rows of source and output at a time are about what a processor's prefetcher can follow: in bands of 32 rows
// sampling takes twice as long.
constexpr int strip_rows = 8;

struct Span {
    int row, first, last, part;
};

}  // namespace

// How a triangle's pixels are made.
struct Painter::Part {
    FaceMap map;
    int samples;  // along each axis of a pixel
};

// The spans of a band's triangles, strip by strip; in each strip in the order of the triangles.
struct Painter::Plan {
    std::vector<Part> parts;
    std::vector<std::vector<Span>> strips;
};

struct Painter::Scratch {
    alignas(16) std::array<unsigned char, longest_run * largest_pixel> pixels;
    alignas(16) std::array<unsigned char, most_samples * longest_run * largest_pixel> samples;
    std::array<double, 4 * longest_run> sums;
};

Painter::Painter(const cv::Mat& pixels, const PixelFormat& format, const TriangleMesh& rest,
                 const Eigen::MatrixX2d& moved, const SnappedMesh& spans, const WarpOptions& options, Simd simd,
                 cv::Mat& out)
    : source_{pixels.data, pixels.step[0], pixels.cols, pixels.rows},
      format_(format),
      rest_(rest),
      moved_(moved),
      spans_(spans),
      canvas_(options.canvas),
      interpolation_(options.interpolation),
      sample_(find_run_sampler(format, options.interpolation, simd, source_)),
      ops_(find_pixel_ops(format)),
      out_(out) {}

// What `fill` writes goes straight into the picture, or over what is there.
template <class Fill>
void Painter::lay(int row, int first, int count, Scratch& scratch, const Fill& fill) const {
    unsigned char* pixels = out_.ptr(row) + static_cast<std::size_t>(first) * format_.out_bytes();
    if (!ops_.any_alpha || !ops_.any_alpha(pixels, count)) {
        fill(pixels);
        return;
    }
    fill(scratch.pixels.data());
    ops_.over(scratch.pixels.data(), pixels, count);
}

void Painter::sample_span(const FaceMap& map, int row, int first, int last, Scratch& scratch) const {
    for (int x = first; x < last; x += longest_run) {
        const int count = std::min(longest_run, last - x);
        const Run run = map.run(centre_x(x), centre_y(row), 1, count);
        lay(row, x, count, scratch, [&](void* pixels) { sample_(source_, run, pixels); });
    }
}

// The pixel's square is sampled on a grid, with the triangle's map also where the square reaches over its edges.
void Painter::supersample_span(const FaceMap& map, int samples, int row, int first, int last, Scratch& scratch) const {
    const double step = 1.0 / samples;
    for (int x = first; x < last; x += longest_run) {
        const int count = std::min(longest_run, last - x);
        std::fill_n(scratch.sums.data(), 4 * count, 0.0);
        for (int k = 0; k < samples; ++k) {
            const double x_first = centre_x(x) + (step - 1) / 2, y = centre_y(row) + (k + 0.5) * step - 0.5;
            sample_(source_, map.run(x_first, y, step, samples * count), scratch.samples.data());
            ops_.add_samples(scratch.samples.data(), count, samples, scratch.sums.data());
        }
        lay(row, x, count, scratch,
            [&](void* pixels) { ops_.store_means(scratch.sums.data(), count, samples * samples, pixels); });
    }
}

void Painter::copy_span(const FaceMap& map, int row, int first, int last, Scratch& scratch) const {
    // In 64 bits: triangles far away have long shifts.
    const std::int64_t shift_x = std::int64_t{map.shift().x()} - canvas_.x;
    const std::int64_t shift_y = std::int64_t{map.shift().y()} - canvas_.y;
    for (int x = first; x < last; x += longest_run) {
        const int count = std::min(longest_run, last - x);
        lay(row, x, count, scratch,
            [&](void* pixels) { ops_.copy(source_, x - shift_x, row - shift_y, count, pixels); });
    }
}

Painter::Plan Painter::planned(RowRange band) const {
    Plan plan;
    plan.strips.resize(static_cast<std::size_t>(band.last - band.first - 1) / strip_rows + 1);
    spans_.for_each_triangle_in(band, [&](int triangle) {
        const FaceMap map(rest_, moved_, triangle);
        const int part = static_cast<int>(plan.parts.size());
        plan.parts.push_back({map, interpolation_ == Interpolation::nearest ? 1 : map.samples()});
        spans_.for_each_span_of(triangle, band, [&](int row, int first, int last) {
            plan.strips[static_cast<std::size_t>((row - band.first) / strip_rows)].push_back({row, first, last, part});
        });
    });
    return plan;
}

void Painter::clear(RowRange rows) const {
    for (int row = rows.first; row < rows.last; ++row) {
        std::memset(out_.ptr(row), 0, format_.out_bytes() * static_cast<std::size_t>(canvas_.width));
    }
}

void Painter::paint(RowRange band) const {
    const Plan plan = planned(band);
    Scratch scratch;
    int row = band.first;
    for (const std::vector<Span>& strip : plan.strips) {
        const RowRange rows{row, std::min(row + strip_rows, band.last)};
        row = rows.last;
        if (format_.out_has_alpha()) clear(rows);
        for (const Span& span : strip) {
            const Part& part = plan.parts[static_cast<std::size_t>(span.part)];
            if (part.map.is_copy()) {
                copy_span(part.map, span.row, span.first, span.last, scratch);
            } else if (part.samples == 1) {
                sample_span(part.map, span.row, span.first, span.last, scratch);
            } else {
                supersample_span(part.map, part.samples, span.row, span.first, span.last, scratch);
            }
        }
    }
}

}  // namespace puppetwarp::detail
