#include <puppetwarp/project/source_picture.h>

#include <puppetwarp/base/errors.h>

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <optional>
#include <string>

namespace puppetwarp {

namespace {

CutoutSource source_from_name(const std::string& name) {
    if (name == "auto") return CutoutSource::automatic;
    if (name == "alpha") return CutoutSource::alpha;
    if (name == "mask") return CutoutSource::mask;
    if (name == "polygon") return CutoutSource::polygon;
    if (name == "whole") return CutoutSource::whole;
    throw InvalidInput("cutout '" + name + "'", "is unknown", "use auto, alpha, mask, polygon or whole");
}

std::string size_text(int width, int height) {
    return std::to_string(width) + " x " + std::to_string(height);
}

cv::Mat resized(const cv::Mat& pixels, int width, int height) {
    cv::Mat result;
    cv::resize(pixels, result, {width, height}, 0, 0, width < pixels.cols ? cv::INTER_AREA : cv::INTER_LINEAR);
    return result;
}

// Means round thin parts away; the mesh must cover them all the same.
template <class T>
void keep_covered(const cv::Mat& from, cv::Mat& to) {
    const T least = std::is_floating_point_v<T> ? static_cast<T>(1.0 / 255) : T{1};
    for (int y = 0; y < from.rows; ++y) {
        const T* row = from.ptr<T>(y);
        T* target = to.ptr<T>(static_cast<int>(std::int64_t{y} * to.rows / from.rows));
        for (int x = 0; x < from.cols; ++x) {
            if (!(row[x] > 0)) continue;
            T& value = target[std::int64_t{x} * to.cols / from.cols];
            if (!(value > 0)) value = least;
        }
    }
}

}  // namespace

bool SourceSize::is_same_shape() const {
    const std::int64_t difference = std::int64_t{width} * rig_height - std::int64_t{height} * rig_width;
    return std::abs(difference) <= std::max(std::int64_t{width} + height, std::int64_t{rig_width} + rig_height);
}

SourceSize source_size(const Puppet& puppet, const std::filesystem::path& other, const ReadOptions& read) {
    const std::filesystem::path own = puppet.image.empty() ? other : resolve(puppet, puppet.image);
    if (own.empty()) throw InvalidInput("puppet", "names no picture", "add the field `image`");
    const ImageInfo drawn = read_image_info(other.empty() ? own : other, read);
    // Of the rig's picture only the header is read: it may be of any size.
    const ImageInfo rig = read_image_info(own, {std::numeric_limits<std::int64_t>::max()});
    const SourceSize size{drawn.width, drawn.height, rig.width, rig.height};
    if (!size.is_same_shape()) {
        throw InvalidInput(other.string(),
                           "is " + size_text(size.width, size.height) + " pixels, another shape than " + own.string() +
                               " with " + size_text(size.rig_width, size.rig_height),
                           "give the same picture at another resolution");
    }
    return size;
}

std::optional<SourceSize> size_of_whole(const Puppet& puppet, const std::filesystem::path& other,
                                        const ReadOptions& read) {
    const CutoutSource from = source_from_name(puppet.cutout.from);
    if (from != CutoutSource::whole && from != CutoutSource::automatic) return std::nullopt;
    if (other.empty() && puppet.image.empty()) return std::nullopt;
    try {
        const ImageInfo info = read_image_info(other.empty() ? resolve(puppet, puppet.image) : other, read);
        if (info.has_alpha && from == CutoutSource::automatic) return std::nullopt;
        if (other.empty()) return SourceSize{info.width, info.height, info.width, info.height};
        return source_size(puppet, other, read);
    } catch (const Error&) {
        return std::nullopt;
    }
}

CutoutOptions cutout_options(const Puppet& puppet, const ReadOptions& read) {
    CutoutOptions options;
    options.from = source_from_name(puppet.cutout.from);
    options.points = puppet.cutout.points;
    options.holes = puppet.cutout.holes;
    if (options.from == CutoutSource::mask) options.mask = read_image(resolve(puppet, puppet.cutout.path), read);
    return options;
}

Cutout cut_out_at(const SourceSize& size, const Puppet& puppet, const Image& image, const ReadOptions& read) {
    CutoutOptions options = cutout_options(puppet, read);
    if (!size.is_same()) {
        const auto scale = [&](Polyline& points) {
            for (Point& point : points) point = point.cwiseProduct(size.resolution().transpose());
        };
        scale(options.points);
        for (Polyline& hole : options.holes) scale(hole);
        if (options.mask.width() == size.rig_width && options.mask.height() == size.rig_height)
            options.mask.pixels = resized(options.mask.pixels, size.width, size.height);
    }
    return cut_out(image, options);
}

Cutout cutout_for_rig(const Cutout& cutout, const SourceSize& size) {
    if (cutout.whole || size.is_same()) return cutout;
    Cutout small{false, resized(cutout.matte, size.rig_width, size.rig_height)};
    switch (cutout.matte.depth()) {
        case CV_8U: keep_covered<std::uint8_t>(cutout.matte, small.matte); break;
        case CV_16U: keep_covered<std::uint16_t>(cutout.matte, small.matte); break;
        default: keep_covered<float>(cutout.matte, small.matte); break;
    }
    return small;
}

}  // namespace puppetwarp
