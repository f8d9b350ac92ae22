#include <puppetwarp/warp/background.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/base/threads.h>
#include <puppetwarp/warp/light.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

namespace puppetwarp {

namespace {

constexpr int band_rows = 32;
constexpr int rows_looked_at = 256;

int hex_digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    if (c >= 'A' && c <= 'F') return c - 'A' + 10;
    return -1;
}

// Straight colour and alpha of one pixel, in the picture's own numbers.
struct Colour {
    double channel[3] = {};
    double alpha = 0;
};

template <class T>
struct Depth {
    static constexpr double full = std::is_floating_point_v<T> ? 1.0 : static_cast<double>(static_cast<T>(-1));

    static T rounded(double value) {
        if constexpr (std::is_floating_point_v<T>) {
            return static_cast<T>(value);
        } else {
            return static_cast<T>(std::clamp(value + 0.5, 0.0, full));
        }
    }

    static Colour load(const T* p, int channels) {
        Colour colour;
        const int colours = channels <= 2 ? 1 : 3;
        for (int c = 0; c < colours; ++c) colour.channel[c] = p[c];
        colour.alpha = channels % 2 == 0 ? static_cast<double>(p[channels - 1]) : full;
        return colour;
    }

    static void store(const Colour& colour, int channels, T* p) {
        const int colours = channels <= 2 ? 1 : 3;
        for (int c = 0; c < colours; ++c) p[c] = rounded(colour.channel[c]);
        if (channels % 2 == 0) p[channels - 1] = rounded(colour.alpha);
    }
};

Colour over(const Colour& front, const Colour& back, double full) {
    if (front.alpha >= full || back.alpha <= 0) return front;
    if (front.alpha <= 0) return back;
    const double front_weight = front.alpha * full, back_weight = back.alpha * (full - front.alpha);
    const double weight = front_weight + back_weight;
    Colour result;
    for (int c = 0; c < 3; ++c) {
        result.channel[c] = (front.channel[c] * front_weight + back.channel[c] * back_weight) / weight;
    }
    result.alpha = weight / full;
    return result;
}

template <class T>
class Layers {
public:
    //! \param light  for linear light, or null.
    Layers(const Background& background, const cv::Mat& warped, const cv::Mat& original, const Canvas& canvas,
           const detail::LightTables* light)
        : kept_(background.kind == Background::Kind::keep || background.kind == Background::Kind::inpaint),
          warped_(warped),
          original_(original),
          canvas_(canvas),
          light_(light) {
        const auto& rgba = background.rgba;
        if (background.kind == Background::Kind::transparent) return;
        const bool grey = warped_.channels() <= 2;
        // Grey stays grey: a colour gives its luma.
        const double luma = 0.299 * rgba[0] + 0.587 * rgba[1] + 0.114 * rgba[2];
        for (std::size_t c = 0; c < 3; ++c) flat_.channel[c] = as_stored(grey ? luma : rgba[c]);
        flat_.alpha = as_stored(rgba[3]);
    }

    // Whether every pixel ends with full alpha.
    bool opaque() const {
        std::atomic<bool> all = true;
        parallel_for(0, warped_.rows, band_rows, [&](int first, int last) {
            for (int y = first; y < last && all.load(std::memory_order_relaxed); ++y) {
                if (!opaque_row(y)) all = false;
            }
        });
        return all;
    }

    cv::Mat flattened(bool with_alpha) const {
        const int channels = warped_.channels() - (with_alpha ? 0 : 1);
        cv::Mat out(warped_.rows, warped_.cols, CV_MAKETYPE(warped_.depth(), channels));
        parallel_for(0, out.rows, band_rows, [&](int first, int last) {
            for (int y = first; y < last; ++y) flatten_row(y, out.ptr<T>(y), channels);
        });
        return out;
    }

private:
    using D = Depth<T>;

    static double as_stored(double share) { return D::rounded(std::clamp(share, 0.0, 1.0) * D::full); }

    // What stands behind pixel (x, y) of the canvas.
    Colour behind(int x, int y) const {
        if (!kept_) return flat_;
        const std::int64_t column = std::int64_t{x} + canvas_.x, row = std::int64_t{y} + canvas_.y;
        if (column < 0 || row < 0 || column >= original_.cols || row >= original_.rows) return {};
        const int channels = original_.channels();
        return D::load(original_.ptr<T>(static_cast<int>(row)) + column * channels, channels);
    }

    bool opaque_row(int y) const {
        const int channels = warped_.channels();
        const T* p = warped_.ptr<T>(y);
        for (int x = 0; x < warped_.cols; ++x, p += channels) {
            if (p[channels - 1] >= static_cast<T>(D::full)) continue;
            if (D::rounded(over(D::load(p, channels), behind(x, y), D::full).alpha) < static_cast<T>(D::full))
                return false;
        }
        return true;
    }

    Colour blended(const Colour& front, const Colour& back) const {
        if constexpr (!std::is_floating_point_v<T>) {
            if (light_ != nullptr) return encoded(over(decoded(front), decoded(back), D::full));
        }
        return over(front, back, D::full);
    }

    // Colours that are whole numbers, to light and back.
    Colour decoded(Colour colour) const {
        for (int c = 0; c < colours(); ++c) {
            colour.channel[c] = static_cast<double>(light_->decode(c)[static_cast<T>(colour.channel[c])]);
        }
        return colour;
    }
    Colour encoded(Colour colour) const {
        for (int c = 0; c < colours(); ++c) {
            colour.channel[c] = light_->encode(c, static_cast<float>(colour.channel[c]));
        }
        return colour;
    }
    int colours() const { return warped_.channels() <= 2 ? 1 : 3; }

    void flatten_row(int y, T* to, int channels) const {
        const int from_channels = warped_.channels();
        const T* from = warped_.ptr<T>(y);
        for (int x = 0; x < warped_.cols; ++x, from += from_channels, to += channels) {
            if (from[from_channels - 1] >= static_cast<T>(D::full)) {
                std::copy_n(from, channels, to);
            } else {
                D::store(blended(D::load(from, from_channels), behind(x, y)), channels, to);
            }
        }
    }

    bool kept_;
    const cv::Mat& warped_;
    const cv::Mat& original_;
    Canvas canvas_;
    const detail::LightTables* light_;
    Colour flat_;
};

using Light = std::unique_ptr<const detail::LightTables>;

Light light_of(const Image& image, bool linear) {
    return linear && image.pixels.depth() != CV_32F ? std::make_unique<detail::LightTables>(image) : nullptr;
}

// Calls `work` with the layers.
template <class Work>
auto with_layers(const Background& background, const cv::Mat& warped, const cv::Mat& original, const Canvas& canvas,
                 const detail::LightTables* light, const Work& work) {
    switch (warped.depth()) {
        case CV_8U: return work(Layers<std::uint8_t>(background, warped, original, canvas, light));
        case CV_16U: return work(Layers<std::uint16_t>(background, warped, original, canvas, light));
        default: return work(Layers<float>(background, warped, original, canvas, light));
    }
}

bool holds(const Image& image, const Canvas& canvas) {
    return canvas.x >= 0 && canvas.y >= 0 && canvas.width <= image.width() - canvas.x &&
           canvas.height <= image.height() - canvas.y;
}

// Whether the result of laying something with alpha over a background has alpha, if that is known without its pixels.
std::optional<bool> has_alpha_over(const Background& background, std::optional<bool> covered, const Image& original,
                                   const Canvas& canvas) {
    if (original.has_alpha()) return true;
    switch (background.kind) {
        case Background::Kind::transparent: return covered == false ? std::optional(true) : std::nullopt;
        case Background::Kind::colour: return background.rgba[3] >= 1 ? std::optional(false) : std::nullopt;
        default: return holds(original, canvas) ? std::optional(false) : std::nullopt;
    }
}

// Draws rows until some are not opaque: twice at most, against holding the whole picture to look at it.
template <class OpaqueRows>
bool all_opaque(int height, const OpaqueRows& opaque) {
    for (int first = 0; first < height; first += rows_looked_at) {
        if (!opaque(first, std::min(height, first + rows_looked_at))) return false;
    }
    return true;
}

}  // namespace

Background background_from_name(std::string_view name) {
    if (name == "transparent") return {};
    if (name == "keep") return {Background::Kind::keep, {}};
    if (name == "inpaint") return {Background::Kind::inpaint, {}};
    std::vector<int> digits;
    if (!name.empty() && name[0] == '#') {
        for (char c : name.substr(1)) digits.push_back(hex_digit(c));
    }
    const bool is_colour = (digits.size() == 6 || digits.size() == 8) &&
                           std::all_of(digits.begin(), digits.end(), [](int digit) { return digit >= 0; });
    if (!is_colour) {
        throw InvalidInput("background '" + std::string(name) + "'", "unknown",
                           "choose transparent, keep, inpaint, #rrggbb or #rrggbbaa");
    }
    Background background{Background::Kind::colour, {1, 1, 1, 1}};
    for (std::size_t k = 0; k + 1 < digits.size(); k += 2) {
        background.rgba[k / 2] = (16 * digits[k] + digits[k + 1]) / 255.0;
    }
    return background;
}

Image lay_over(const Background& background, const Image& warped, const Image& original, const Canvas& canvas,
               bool linear) {
    if (!warped.has_alpha()) return warped;
    const Light light = light_of(original, linear);
    const auto lay = [&](const auto& layers) {
        const bool with_alpha = original.has_alpha() || !layers.opaque();
        if (with_alpha && background.kind == Background::Kind::transparent) return warped.pixels;
        return layers.flattened(with_alpha);
    };
    return {with_layers(background, warped.pixels, original.pixels, canvas, light.get(), lay), warped.metadata};
}

WarpedRows rows_over(const Background& background, const WarpedRows& warped, const Image& original,
                     const Canvas& canvas, bool linear) {
    const int channels = CV_MAT_CN(warped.picture.type);
    if (channels % 2 != 0) return warped;
    const bool shown = background.kind == Background::Kind::keep || background.kind == Background::Kind::inpaint;
    const std::shared_ptr<const detail::LightTables> light = light_of(original, linear);
    // Calls `work` with the layers of rows [first, last).
    const auto with_rows = [=, front = warped.picture.rows, back = shown ? original.pixels : cv::Mat()](
                               int first, int last, const auto& work) {
        const cv::Mat rows = front(first, last);
        const Canvas place{canvas.x, canvas.y + first, canvas.width, last - first};
        return with_layers(background, rows, back, place, light.get(), work);
    };
    const std::optional<bool> known = has_alpha_over(background, warped.covered, original, canvas);
    const bool with_alpha = known ? *known : !all_opaque(warped.picture.height, [&](int first, int last) {
        return with_rows(first, last, [](const auto& layers) { return layers.opaque(); });
    });
    const bool stays = with_alpha && background.kind == Background::Kind::transparent;
    // A mesh that covers all may show alpha of its own, and what lies over a background may be open where that is.
    const bool open = known ? stays && warped.covered == false : with_alpha;
    WarpedRows result{warped.picture, open ? std::optional(false) : std::nullopt};
    if (stays) return result;
    result.picture.type = CV_MAKETYPE(CV_MAT_DEPTH(warped.picture.type), with_alpha ? channels : channels - 1);
    result.picture.rows = [with_rows, with_alpha](int first, int last) {
        return with_rows(first, last, [&](const auto& layers) { return layers.flattened(with_alpha); });
    };
    return result;
}

}  // namespace puppetwarp
