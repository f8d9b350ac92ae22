#include <puppetwarp/warp/point_sampler.h>

#include <puppetwarp/warp/filters.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace puppetwarp::detail {

namespace {

std::int64_t fixed_point(double value) {
    return static_cast<std::int64_t>(std::llround(value * fixed_one));
}

// The shape for steps that are shorter by the noise.
Footprint shape_of(const Eigen::Matrix2d& slope, double noise, Interpolation interpolation, int top_level) {
    const Eigen::Array2d lengths = slope.colwise().norm().transpose();
    const Eigen::Array2d shorter = (lengths > noise).select(1 - noise / lengths, 0);
    return footprint(slope * shorter.matrix().asDiagonal(), interpolation, top_level);
}

std::unique_ptr<LightTables> light_of(const Image& image, bool linear) {
    return linear && image.pixels.depth() != CV_32F ? std::make_unique<LightTables>(image) : nullptr;
}

}  // namespace

PointSampler::PointSampler(const Image& image, bool adds_alpha, Interpolation interpolation, bool linear)
    : pixels_(image.pixels),
      format_{pixels_.depth(), pixels_.channels(), adds_alpha},
      light_(light_of(image, linear)),
      source_(source_of(pixels_, format_, light_.get())),
      interpolation_(interpolation),
      samplers_(find_samplers(format_, interpolation, light_ != nullptr, best_simd())),
      single_(source_, samplers_.single),
      level_sampler_(level_sampler(format_.channels, interpolation, Simd::scalar)),
      ops_(find_pixel_ops(format_)),
      top_level_(highest_level(source_.width, source_.height)) {}

void PointSampler::sample(const Point& at, const Eigen::Matrix2d& slope, double slope_noise, void* pixel) const {
    const Footprint shape = shape_of(slope, slope_noise, interpolation_, top_level_);
    const Point corner = at - Point(0.5, 0.5);
    if (shape.samples() > 1 || shape.level > 0) {
        sample_several(at, slope, shape, pixel);
    } else if (corner == corner.array().round().matrix()) {
        ops_.copy(source_, std::lround(corner.x()), std::lround(corner.y()), 1, pixel);
    } else {
        sample_one({fixed_point(corner.x()), fixed_point(corner.y()), 0, 0, 1}, pixel);
    }
}

// The pixel's square by a grid of samples, as `warp` has it for the pixels of a triangle.
void PointSampler::sample_several(const Point& at, const Eigen::Matrix2d& slope, const Footprint& shape,
                                  void* pixel) const {
    const ViewFrame frame = shape.level == 0 ? ViewFrame() : pyramid().frame(shape.level);
    const Source view = shape.level == 0 ? source_ : pyramid().level(shape.level);
    const Sampler& sampler = shape.level == 0 ? samplers_.several : level_sampler_;
    std::array<Four, most_samples> samples{};
    std::array<float, most_samples> fades{};
    for (int k = 0; k < shape.samples(); ++k) {
        const auto slot = static_cast<std::size_t>(k);
        const Point place = at + slope * shape.offset_px(k);
        const Point frame_corner(static_cast<double>(frame.x), static_cast<double>(frame.y));
        const Point corner = (place - frame_corner) / static_cast<double>(frame.size) - Point(0.5, 0.5);
        sampler.sample_anywhere(view, {fixed_point(corner.x()), fixed_point(corner.y()), 0, 0, 1}, &samples[slot]);
        fades[slot] = format_.channels % 2 == 1
                          ? 1
                          : fade_at(source_, fixed_point(place.x() - 0.5), fixed_point(place.y() - 0.5));
    }
    samplers_.store(source_, samples.data(), fades.data(), 1, shape.samples(), pixel);
}

void PointSampler::sample_one(const Run& at, void* pixel) const {
    const Sampler& sampler = single_.sampler;
    if (sampler.gives_pixels) {
        sampler.sample_anywhere(source_, at, pixel);
        return;
    }
    Four sample;
    sampler.sample_anywhere(source_, at, &sample);
    const float fade = format_.channels % 2 == 1 ? 1 : fade_at(source_, at.u, at.v);
    samplers_.store(source_, &sample, &fade, 1, 1, pixel);
}

const Pyramid& PointSampler::pyramid() const {
    std::call_once(pyramid_made_, [&] {
        pyramid_ = Pyramid(source_, samplers_.read, {0, 0, source_.width, source_.height}, top_level_);
    });
    return pyramid_;
}

void PointSampler::alpha(const Run& run, float* alpha) const {
    std::array<unsigned char, longest_run * 4 * sizeof(float)> pixels;
    Batch batch(format_, ops_, samplers_.store, source_, {pixels.data(), 0, 0});
    batch.expect_overlaps(false);
    batch.sample(single_, {0, 0, run.count}, &run, 1);
    batch.flush();
    switch (format_.depth) {
        case CV_8U: take_alpha<std::uint8_t>(pixels.data(), run.count, 1 / 255.0F, alpha); break;
        case CV_16U: take_alpha<std::uint16_t>(pixels.data(), run.count, 1 / 65535.0F, alpha); break;
        default: take_alpha<float>(pixels.data(), run.count, 1, alpha); break;
    }
}

template <class T>
void PointSampler::take_alpha(const void* pixels, int count, float unit, float* alpha) const {
    const T* p = static_cast<const T*>(pixels) + format_.channels - 1;
    for (int i = 0; i < count; ++i, p += format_.channels) alpha[i] = static_cast<float>(*p) * unit;
}

}  // namespace puppetwarp::detail
