#include <puppetwarp/cutout/cutout.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/base/threads.h>
#include <puppetwarp/cutout/coverage.h>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <cmath>
#include <cstdio>

namespace puppetwarp {

namespace {

cv::Mat alpha_of(const Image& image) {
    cv::Mat alpha;
    cv::extractChannel(image.pixels, alpha, image.alpha_channel());
    return alpha;
}

void require_visible(const cv::Mat& matte, const char* subject, const char* reason, const char* advice) {
    double most = 0;
    cv::minMaxLoc(matte, nullptr, &most);
    if (!(most > 0)) throw InvalidInput(subject, reason, advice);
}

// Float mattes may come with anything in them: coverage is from 0 to 1, and what is not a number is nothing.
void tidy(cv::Mat& matte) {
    if (matte.depth() != CV_32F) return;
    cv::patchNaNs(matte, 0);
    cv::min(cv::max(matte, 0), 1, matte);
}

Cutout from_alpha(const Image& image) {
    if (!image.has_alpha()) {
        throw InvalidInput("cutout", "the picture has no alpha", "cut out by mask or polygon, or take the whole");
    }
    Cutout cutout{false, alpha_of(image)};
    tidy(cutout.matte);
    require_visible(cutout.matte, "picture", "every pixel is transparent",
                    "there is no subject; use the cutout `whole` to warp it anyway");
    return cutout;
}

Cutout from_mask(const Image& image, const Image& mask) {
    if (mask.pixels.empty()) throw InvalidInput("mask", "there is none", "name the mask's picture");
    if (mask.pixels.size() != image.pixels.size()) {
        char reason[128];
        std::snprintf(reason, sizeof(reason), "it is %d x %d pixels and the picture %d x %d", mask.width(),
                      mask.height(), image.width(), image.height());
        throw InvalidInput("mask", reason, "make them the same size");
    }
    Cutout cutout;
    if (mask.pixels.channels() <= 2) {
        cv::extractChannel(mask.pixels, cutout.matte, 0);
    } else {
        cv::cvtColor(mask.pixels, cutout.matte, mask.has_alpha() ? cv::COLOR_RGBA2GRAY : cv::COLOR_RGB2GRAY);
    }
    tidy(cutout.matte);
    if (mask.has_alpha()) {
        cv::Mat alpha = alpha_of(mask);
        tidy(alpha);
        cv::multiply(cutout.matte, alpha, cutout.matte, 1 / mask.full_value());
    }
    require_visible(cutout.matte, "mask", "it is black everywhere", "paint the subject white");
    return cutout;
}

double cross(const Point& a, const Point& b, const Point& c) {
    return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

bool cross_properly(const Point& a, const Point& b, const Point& c, const Point& d) {
    return cross(a, b, c) * cross(a, b, d) < 0 && cross(c, d, a) * cross(c, d, b) < 0;
}

void require_polygon(const Polyline& points, const char* subject) {
    if (points.size() < 3) throw InvalidInput(subject, "it has fewer than three points");
    for (const Point& point : points) {
        if (!point.allFinite()) throw InvalidInput(subject, "a coordinate is not a finite number");
        if (point.lpNorm<Eigen::Infinity>() > 1e9)
            throw InvalidInput(subject, "a point is farther out than 1e9 pixels");
    }
    // Drawn by hand or a tool, these have few points: every pair is looked at.
    const std::size_t count = points.size();
    for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t k = i + 2; k < count; ++k) {
            if (cross_properly(points[i], points[i + 1], points[k], points[(k + 1) % count])) {
                char reason[96];
                std::snprintf(reason, sizeof(reason), "edge %zu crosses edge %zu", i + 1, k + 1);
                throw InvalidInput(subject, reason, "move its points so that the outline does not cross itself");
            }
        }
    }
}

Cutout from_polygon(const Image& image, const CutoutOptions& options) {
    require_polygon(options.points, "polygon");
    for (const Polyline& hole : options.holes) require_polygon(hole, "hole of the polygon");
    cv::Mat matte = polygon_coverage({options.points}, image.width(), image.height());
    if (!options.holes.empty()) {
        // One by one, so that holes may overlap or lie partly outside.
        for (const Polyline& hole : options.holes) {
            const cv::Mat kept = 255 - polygon_coverage({hole}, image.width(), image.height());
            cv::min(matte, kept, matte);
        }
    }
    require_visible(matte, "polygon", "no pixel of the picture is inside it",
                    "give its points in pixels of the picture");
    return {false, matte};
}

bool mostly_see_through_somewhere(const Image& image) {
    if (!image.has_alpha()) return false;
    double least = 0;
    cv::minMaxLoc(alpha_of(image), &least);
    return least < image.full_value() / 2;
}

// value * coverage / full, rounded to the nearest.
template <class T>
T product(T value, T coverage) {
    if constexpr (std::is_floating_point_v<T>) {
        return value * coverage;
    } else {
        constexpr std::uint64_t full = std::numeric_limits<T>::max();
        return static_cast<T>((std::uint64_t{value} * coverage + full / 2) / full);
    }
}

// Between depths the full values correspond; OpenCV rounds to the nearest.
cv::Mat in_depth(const cv::Mat& matte, int depth) {
    const auto full = [](int some) { return some == CV_8U ? 255.0 : some == CV_16U ? 65535.0 : 1.0; };
    if (matte.depth() == depth) return matte;
    cv::Mat converted;
    matte.convertTo(converted, depth, full(depth) / full(matte.depth()));
    return converted;
}

template <class T>
void multiply_alpha(cv::Mat& pixels, const cv::Mat& matte) {
    const int channels = pixels.channels();
    for (int j = 0; j < pixels.rows; ++j) {
        T* alpha = pixels.ptr<T>(j) + channels - 1;
        const T* coverage = matte.ptr<T>(j);
        for (int i = 0; i < pixels.cols; ++i) alpha[i * channels] = product(alpha[i * channels], coverage[i]);
    }
}

// Some rows with alpha, into `result`.
void copy_with_alpha(const cv::Mat& pixels, double full, cv::Mat result) {
    if (pixels.channels() == result.channels()) {
        pixels.copyTo(result);
        return;
    }
    const cv::Mat opaque(pixels.size(), pixels.depth(), cv::Scalar(full));
    constexpr std::array same{0, 0, 1, 1, 2, 2, 3, 3};
    const std::array sources{pixels, opaque};
    cv::mixChannels(sources.data(), sources.size(), &result, 1, same.data(),
                    static_cast<std::size_t>(result.channels()));
}

}  // namespace

Cutout cut_out(const Image& image, const CutoutOptions& options) {
    switch (options.from) {
        case CutoutSource::automatic: return mostly_see_through_somewhere(image) ? from_alpha(image) : Cutout{true, {}};
        case CutoutSource::alpha: return from_alpha(image);
        case CutoutSource::mask: return from_mask(image, options.mask);
        case CutoutSource::polygon: return from_polygon(image, options);
        case CutoutSource::whole: break;
    }
    return {true, {}};
}

Image apply_cutout(const Image& image, const Cutout& cutout) {
    if (cutout.whole || cutout.matte.empty()) return image;
    // An alpha cutout's matte is the alpha itself: multiplying it by itself would thin every soft edge.
    if (image.has_alpha() && cutout.matte.depth() == image.pixels.depth()) {
        if (cv::norm(alpha_of(image), cutout.matte, cv::NORM_INF) == 0) return image;
    }
    const int channels = image.pixels.channels() + (image.has_alpha() ? 0 : 1);
    const int depth = image.pixels.depth();
    Image result{cv::Mat(image.pixels.size(), CV_MAKETYPE(depth, channels)), image.metadata};
    parallel_for(0, image.height(), 64, [&](int first, int last) {
        cv::Mat rows = result.pixels.rowRange(first, last);
        copy_with_alpha(image.pixels.rowRange(first, last), image.full_value(), rows);
        const cv::Mat matte = in_depth(cutout.matte.rowRange(first, last), depth);
        if (depth == CV_8U) multiply_alpha<std::uint8_t>(rows, matte);
        if (depth == CV_16U) multiply_alpha<std::uint16_t>(rows, matte);
        if (depth == CV_32F) multiply_alpha<float>(rows, matte);
    });
    return result;
}

}  // namespace puppetwarp
