#pragma once

#include <puppetwarp/warp/sampling.h>

// Shared by the files for instruction sets. Internal linkage on purpose: each of them is compiled for another one.
namespace puppetwarp::detail {

namespace {

inline Run part(const Run& run, int first, int last) {
    return {run.u + first * run.du, run.v + first * run.dv, run.du, run.dv, last - first};
}

// Which pixels of a run have all their taps, and all bytes that are loaded with them, inside the picture.
template <int C, class Kernel>
struct Inside {
    std::int64_t x_end, y_end;

    explicit Inside(const SourceView& source)
        : x_end(source.width - (Kernel::bytes_loaded + C - 1) / C + 1), y_end(source.height - Kernel::taps + 1) {}

    bool operator()(std::int64_t u, std::int64_t v) const {
        const std::int64_t x = (u >> 32) - Kernel::before, y = (v >> 32) - Kernel::before;
        return x >= 0 && y >= 0 && x < x_end && y < y_end;
    }
};

template <int C, bool AddsAlpha>
RunSampler scalar_sampler(Interpolation interpolation) {
    return find_scalar_sampler({CV_8U, C, AddsAlpha}, interpolation);
}

// The middle of a run lies inside, as the picture is convex: that part goes to `sample_inside`, the ends to scalar
// code.
template <int C, bool AddsAlpha, class Kernel, class SampleInside>
void sample_in_parts(Interpolation interpolation, const SourceView& source, const Run& run, std::uint8_t* out,
                     const SampleInside& sample_inside) {
    constexpr int out_channels = C + AddsAlpha;
    const Inside<C, Kernel> inside(source);
    const std::int64_t last_u = run.u + (run.count - 1) * run.du, last_v = run.v + (run.count - 1) * run.dv;
    if (inside(run.u, run.v) && inside(last_u, last_v)) {
        sample_inside(run, out);
        return;
    }
    int first = 0, last = run.count;
    while (first < last && !inside(run.u + first * run.du, run.v + first * run.dv)) ++first;
    while (first < last && !inside(run.u + (last - 1) * run.du, run.v + (last - 1) * run.dv)) --last;
    const auto sample_end = [&](int begin, int end) {
        if (begin == end) return;
        scalar_sampler<C, AddsAlpha>(interpolation)(source, part(run, begin, end), out + out_channels * begin);
    };
    sample_end(0, first);
    if (first < last) sample_inside(part(run, first, last), out + out_channels * first);
    sample_end(last, run.count);
}

}  // namespace

}  // namespace puppetwarp::detail
