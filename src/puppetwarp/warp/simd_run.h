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

// The middle of a run lies inside, as the picture is convex: that part goes to `inside`, the ends to `scalar`.
template <int C, bool AddsAlpha, class Kernel, class InsideSampler>
void sample_in_parts(const SourceView& source, const Run& run, std::uint8_t* out, RunSampler scalar,
                     InsideSampler inside_sampler) {
    constexpr int out_channels = C + AddsAlpha;
    const Inside<C, Kernel> inside(source);
    int first = 0, last = run.count;
    while (first < last && !inside(run.u + first * run.du, run.v + first * run.dv)) ++first;
    while (first < last && !inside(run.u + (last - 1) * run.du, run.v + (last - 1) * run.dv)) --last;
    if (first > 0) scalar(source, part(run, 0, first), out);
    if (first < last) inside_sampler(source, part(run, first, last), out + out_channels * first, scalar);
    if (last < run.count) scalar(source, part(run, last, run.count), out + out_channels * last);
}

}  // namespace

}  // namespace puppetwarp::detail
