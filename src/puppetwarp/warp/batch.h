#pragma once

#include <puppetwarp/warp/face_map.h>
#include <puppetwarp/warp/pixel_ops.h>
#include <puppetwarp/warp/sampling.h>

#include <opencv2/core/mat.hpp>

#include <array>
#include <vector>

namespace puppetwarp::detail {

//! Consecutive rows of the canvas in memory, that are painted.
struct CanvasRows {
    std::uint8_t* pixels;
    std::size_t step;  //!< bytes from a row to the next
    int first_row;     //!< of the canvas

    std::uint8_t* row(int row) const { return pixels + step * static_cast<std::size_t>(row - first_row); }
};

//! A picture as samplers read it; shares its pixels. \param light  for linear light, or null.
Source source_of(const cv::Mat& pixels, const PixelFormat& format, const LightTables* light);

//! A sampler with what it reads: the source, or a level of its pyramid.
struct SampledView {
    Source source;
    Sampler sampler;
    ViewFrame frame;

    //! First position (shifted, in pixels) beyond those whose taps all lie inside. None may lie inside.
    std::int64_t x_end = 0, y_end = 0;

    SampledView(const Source& some_source, const Sampler& some_sampler, const ViewFrame& some_frame = {});

    //! Whether all positions of a triangle lie inside.
    bool holds(const FaceMap& map) const;
    bool inside(std::int64_t u, std::int64_t v) const {
        return static_cast<std::uint64_t>((u + sampler.shift) >> 32) < static_cast<std::uint64_t>(x_end) &&
               static_cast<std::uint64_t>((v + sampler.shift) >> 32) < static_cast<std::uint64_t>(y_end);
    }
};

//! Spans of a picture to be painted, in their order. Many short spans are sampled in one go, whatever their triangles.
class Batch {
public:
    static constexpr int capacity = 512;  //!< samples; their buffers stay in the first cache

    //! Keeps references. \param out  receives the pixels.
    Batch(const PixelFormat& format, const PixelOps& ops, StoreMeans store_means, const Source& source,
          const CanvasRows& out);

    //! Where a span goes.
    struct Target {
        int row, first, count;
        float coverage = 1;
    };

    //! Pixels of the source that are copied from (x, y) on.
    void copy(const Target& target, std::int64_t x, std::int64_t y);
    //! Pixels from runs of as many positions, the means of more than one: at most `capacity` samples in all.
    void sample(const SampledView& view, const Target& target, const Run* runs, int samples_a_pixel);
    //! Spans that lie inside, of `pixels` in all, at most `capacity`. Painted at once.
    void sample_inside(const SampledView& view, const Span* spans, int count, int pixels, const Steps* steps);
    void flush();

    //! Whether spans from here on may lie over what is painted already. If not, nothing is blended.
    void expect_overlaps(bool expected) { overlaps_ = expected; }

private:
    struct Entry {
        Target target;
        int slot;  // of the first sample; -1: copied
        int samples;
        std::int64_t x, y;
    };
    struct Stray {  // positions near or beyond the border
        Run run;
        int slot;
    };

    Places places() { return {first_.data(), fx_.data(), fy_.data()}; }
    void place(const Run& run);
    void sample_all();
    const void* pixels_of(const Entry& entry);
    void sample_placed(const SampledView& view, int count);
    void fade_strays();
    const void* stored(int slot, int count, int samples_a_pixel, const float* fades);
    std::uint8_t* address(int row, int first) {
        return out_.row(row) + format_.out_bytes() * static_cast<std::size_t>(first);
    }
    void lay(const Target& target, const void* pixels);

    const PixelFormat format_;
    const PixelOps& ops_;
    StoreMeans store_means_;
    const Source& source_;
    const CanvasRows out_;
    bool overlaps_ = true;
    const SampledView* view_ = nullptr;
    int used_ = 0;
    std::vector<Entry> entries_;
    std::vector<Span> spans_;
    std::vector<Steps> steps_;
    std::vector<Stray> strays_;
    static constexpr int room = capacity + places_padding;
    alignas(32) std::array<std::uint32_t, room> first_, fx_, fy_;
    static constexpr std::size_t largest_pixel = 4 * sizeof(float);
    alignas(32) std::array<std::uint8_t, (room + 1) * largest_pixel> samples_;
    std::array<float, capacity> fades_;
    alignas(32) std::array<std::uint8_t, capacity * largest_pixel> pixels_;
};

}  // namespace puppetwarp::detail
