#include <puppetwarp/warp/batch.h>

#include <puppetwarp/warp/filters.h>

#include <algorithm>
#include <cstring>
#include <limits>

namespace puppetwarp::detail {

namespace {

// As memcpy, for the few bytes of a span: no call, and no branch but for the loop's.
void copy_bytes(std::uint8_t* to, const std::uint8_t* from, std::size_t size) {
    constexpr std::size_t chunk = 16;
    if (size < chunk) {
        std::memcpy(to, from, size);
        return;
    }
    for (std::size_t i = 0; i < size - chunk; i += chunk) std::memcpy(to + i, from + i, chunk);
    std::memcpy(to + size - chunk, from + size - chunk, chunk);
}

}  // namespace

Source source_of(const cv::Mat& pixels, const PixelFormat& format, const LightTables* light) {
    Source source;
    source.data = pixels.data;
    source.step = pixels.step[0];
    source.width = pixels.cols;
    source.height = pixels.rows;
    source.channels = format.channels;
    source.channel_bytes = format.channel_bytes();
    source.adds_alpha = format.adds_alpha;
    source.light = light;
    return source;
}

SampledView::SampledView(const Source& some_source, const Sampler& some_sampler, const ViewFrame& some_frame)
    : source(some_source), sampler(some_sampler), frame(some_frame) {
    const std::size_t channels_in_all = source.step / source.channel_bytes * static_cast<std::size_t>(source.height);
    if (channels_in_all > std::numeric_limits<std::uint32_t>::max()) return;
    const int pixel_bytes = source.channels * static_cast<int>(source.channel_bytes);
    const int pixels_loaded = (sampler.bytes_loaded + pixel_bytes - 1) / pixel_bytes;
    // A level's last pixels may reach out of the picture.
    const int spare = frame.size > 1 ? 1 : 0;
    x_end = std::max(0, source.width - std::max(pixels_loaded, sampler.taps) + 1 - spare);
    y_end = std::max(0, source.height - sampler.taps + 1 - spare);
}

bool SampledView::holds(const FaceMap& map) const {
    // First taps from whole numbers of pixels on, positions from centres: a pixel more on every side does for both.
    const double shift = static_cast<double>(sampler.shift) / fixed_one;
    const Eigen::Array2d low = Eigen::Array2d::Constant(1 - shift);
    return map.inside(low, Eigen::Array2d(static_cast<double>(x_end), static_cast<double>(y_end)) - shift - 1);
}

Batch::Batch(const PixelFormat& format, const PixelOps& ops, StoreMeans store_means, const Source& source,
             const CanvasRows& out)
    : format_(format), ops_(ops), store_means_(store_means), source_(source), out_(out) {}

void Batch::copy(const Target& target, std::int64_t x, std::int64_t y) {
    entries_.push_back({target, -1, 1, x, y});
}

void Batch::sample(const SampledView& view, const Target& target, const Run* runs, int samples_a_pixel) {
    const int samples = samples_a_pixel * target.count;
    if (view_ != &view || used_ + samples > capacity) flush();
    view_ = &view;
    entries_.push_back({target, used_, samples_a_pixel, 0, 0});
    for (int i = 0; i < samples_a_pixel; ++i) place(runs[i]);
}

// The middle of a run lies inside, as the picture is convex; its ends may be strays, which hold their place with the
// upper left position inside, if there is any.
void Batch::place(const Run& run) {
    const SampledView& view = *view_;
    const auto part = [&](int begin, int end) {
        return Run{run.u + begin * run.du, run.v + begin * run.dv, run.du, run.dv, end - begin};
    };
    const auto hold_place = [&](const Run& some) {
        spans_.push_back(
            {some.u, some.v, static_cast<int>(steps_.size()), 0, 0, static_cast<std::int16_t>(some.count)});
        steps_.push_back({some.du, some.dv});
        used_ += some.count;
    };
    const auto add_inside = [&](const Run& some) {
        hold_place({some.u + view.sampler.shift, some.v + view.sampler.shift, some.du, some.dv, some.count});
    };
    const auto add_stray = [&](const Run& some) {
        if (some.count == 0) return;
        strays_.push_back({some, used_});
        hold_place({0, 0, 0, 0, some.count});
    };
    const auto inside = [&](int i) { return view.inside(run.u + i * run.du, run.v + i * run.dv); };
    if (inside(0) && inside(run.count - 1)) {
        add_inside(run);
        return;
    }
    int first = 0, last = run.count;
    while (first < last && !inside(first)) ++first;
    while (first < last && !inside(last - 1)) --last;
    add_stray(part(0, first));
    if (first < last) add_inside(part(first, last));
    add_stray(part(last, run.count));
}

void Batch::sample_placed(const SampledView& view, int count) {
    const Places all = places();
    for (int i = count; i < count + places_padding; ++i) {
        all.first[i] = all.first[0];
        all.fx[i] = all.fy[i] = 0;
    }
    view.sampler.sample(view.source, all, count, samples_.data());
}

void Batch::sample_inside(const SampledView& view, const Span* spans, int count, int pixels, const Steps* steps) {
    flush();
    view_ = &view;
    view.sampler.place(view.source, spans, count, steps, places());
    sample_placed(view, pixels);
    const auto* from = static_cast<const std::uint8_t*>(stored(0, pixels, 1, nullptr));
    const std::size_t pixel_bytes = format_.out_bytes();
    for (const Span* span = spans; span != spans + count; ++span) {
        const std::size_t size = pixel_bytes * static_cast<std::size_t>(span->count);
        if (overlaps_) {
            lay({span->row, span->first, span->count}, from);
        } else {
            copy_bytes(address(span->row, span->first), from, size);
        }
        from += size;
    }
}

// Pixels from samples; the same memory when the sampler gave pixels.
const void* Batch::stored(int slot, int count, int samples_a_pixel, const float* fades) {
    const std::uint8_t* samples = samples_.data() + static_cast<std::size_t>(slot) * view_->sampler.out_bytes;
    if (view_->sampler.gives_pixels) return samples;
    store_means_(source_, samples, fades, count, samples_a_pixel, pixels_.data());
    return pixels_.data();
}

void Batch::sample_all() {
    const SampledView& view = *view_;
    int stray_count = 0;
    for (const Stray& stray : strays_) stray_count += stray.run.count;
    if (stray_count < used_) {
        view.sampler.place(view.source, spans_.data(), static_cast<int>(spans_.size()), steps_.data(), places());
        sample_placed(view, used_);
    }
    for (const Stray& stray : strays_) {
        view.sampler.sample_anywhere(view.source, stray.run,
                                     samples_.data() + static_cast<std::size_t>(stray.slot) * view.sampler.out_bytes);
    }
    if (!view.sampler.gives_pixels && !strays_.empty()) fade_strays();
}

void Batch::fade_strays() {
    fades_.fill(1);
    if (view_->source.channels % 2 == 1) return;
    for (const Stray& stray : strays_) {
        for (int i = 0; i < stray.run.count; ++i) {
            const std::int64_t u = view_->frame.source_u(stray.run.u + i * stray.run.du);
            const std::int64_t v = view_->frame.source_v(stray.run.v + i * stray.run.dv);
            const int slot = stray.slot + i;
            fades_[static_cast<std::size_t>(slot)] = fade_at(source_, u, v);
        }
    }
}

const void* Batch::pixels_of(const Entry& entry) {
    const int count = entry.target.count;
    if (entry.slot >= 0) {
        return stored(entry.slot, count, entry.samples, strays_.empty() ? nullptr : fades_.data() + entry.slot);
    }
    ops_.copy(source_, entry.x, entry.y, count, pixels_.data());
    return pixels_.data();
}

void Batch::lay(const Target& target, const void* pixels) {
    std::array<std::uint8_t, largest_pixel> part;
    if (target.coverage < 1) {
        std::memcpy(part.data(), pixels, format_.out_bytes());
        ops_.fade(part.data(), target.coverage);
        pixels = part.data();
    }
    std::uint8_t* to = address(target.row, target.first);
    if (overlaps_ && ops_.any_alpha != nullptr && ops_.any_alpha(to, target.count)) {
        ops_.over(source_.light, pixels, to, target.count);
        return;
    }
    copy_bytes(to, static_cast<const std::uint8_t*>(pixels),
               static_cast<std::size_t>(target.count) * format_.out_bytes());
}

void Batch::flush() {
    if (entries_.empty()) return;
    if (used_ > 0) sample_all();
    for (const Entry& entry : entries_) lay(entry.target, pixels_of(entry));
    entries_.clear();
    spans_.clear();
    steps_.clear();
    strays_.clear();
    used_ = 0;
}

}  // namespace puppetwarp::detail
