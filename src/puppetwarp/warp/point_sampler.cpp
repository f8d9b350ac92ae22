#include <puppetwarp/warp/point_sampler.h>

#include <puppetwarp/warp/face_map.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace puppetwarp::detail {

namespace {

int samples_for(const Eigen::Matrix2d& slope, double noise) {
    if (slope.squaredNorm() <= single_sample_limit * single_sample_limit) return 1;
    const double same = std::hypot(slope(0, 0) + slope(1, 1), slope(1, 0) - slope(0, 1));
    const double opposite = std::hypot(slope(0, 0) - slope(1, 1), slope(1, 0) + slope(0, 1));
    const double largest_stretch = (same + opposite) / 2;
    if (!(largest_stretch > single_sample_limit + noise)) return 1;
    return static_cast<int>(std::ceil(std::min<double>(largest_stretch - noise, most_samples)));
}

std::int64_t fixed_point(double value) {
    return static_cast<std::int64_t>(std::llround(value * fixed_one));
}

}  // namespace

PointSampler::PointSampler(const Image& image, bool adds_alpha, Interpolation interpolation)
    : pixels_(image.pixels),
      source_{pixels_.data, pixels_.step[0], pixels_.cols, pixels_.rows},
      format_{pixels_.depth(), pixels_.channels(), adds_alpha},
      interpolation_(interpolation),
      sample_run_(find_run_sampler(format_, interpolation, best_simd(), source_)),
      sample_one_(find_scalar_sampler(format_, interpolation)),
      ops_(find_pixel_ops(format_)) {}

void PointSampler::sample(const Point& at, const Eigen::Matrix2d& slope, double slope_noise, void* pixel) const {
    const int samples = interpolation_ == Interpolation::nearest ? 1 : samples_for(slope, slope_noise);
    const Point corner = at - Point(0.5, 0.5);
    if (samples > 1) {
        supersample(at, slope, samples, pixel);
    } else if (corner == corner.array().round().matrix()) {
        ops_.copy(source_, std::lround(corner.x()), std::lround(corner.y()), 1, pixel);
    } else {
        sample_one_(source_, {fixed_point(corner.x()), fixed_point(corner.y()), 0, 0, 1}, pixel);
    }
}

// The pixel's square on a grid, as `warp` has it for the pixels of a triangle.
void PointSampler::supersample(const Point& at, const Eigen::Matrix2d& slope, int samples, void* pixel) const {
    alignas(16) std::array<unsigned char, most_samples * 4 * sizeof(float)> row;
    std::array<double, 4> sums{};
    const double step = 1.0 / samples;
    const Point along = slope.col(0) * step;
    for (int k = 0; k < samples; ++k) {
        const Point offset((step - 1) / 2, (k + 0.5) * step - 0.5);
        const Point corner = at + slope * offset - Point(0.5, 0.5);
        sample_one_(
            source_,
            {fixed_point(corner.x()), fixed_point(corner.y()), fixed_point(along.x()), fixed_point(along.y()), samples},
            row.data());
        ops_.add_samples(row.data(), 1, samples, sums.data());
    }
    ops_.store_means(sums.data(), 1, samples * samples, pixel);
}

void PointSampler::alpha(const Run& run, float* alpha) const {
    alignas(16) std::array<unsigned char, longest_run * 4 * sizeof(float)> pixels;
    sample_run_(source_, run, pixels.data());
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
