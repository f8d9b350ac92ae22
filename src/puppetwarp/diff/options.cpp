#include <puppetwarp/diff/options.h>

#include <puppetwarp/base/errors.h>

#include <array>
#include <cmath>
#include <limits>
#include <sstream>
#include <string_view>

namespace puppetwarp {

namespace {

constexpr std::array<std::string_view, 5> kMetricNames{"max", "rmse", "psnr", "ssim", "flip"};
constexpr std::array<std::string_view, 3> kAlphaNames{"straight", "premultiplied", "ignore"};
constexpr int kLargestWindow = 1024;
constexpr int kLargestShift = 64;

template <class Names>
std::size_t index_of(const Names& names, const std::string& name, const std::string& what) {
    std::string known;
    for (std::size_t i = 0; i < names.size(); ++i) {
        if (names[i] == name) return i;
        known += (i == 0 ? "" : ", ") + std::string(names[i]);
    }
    throw InvalidInput(what + " '" + name + "'", "is not known", "use one of " + known);
}

std::string with_value(const std::string& name, double value) {
    std::ostringstream text;
    text << name << ' ' << value;
    return text.str();
}

void require_within(const std::string& name, double value, double least, double most, const std::string& advice) {
    if (value >= least && value <= most) return;
    std::ostringstream reason;
    reason << "is not between " << least << " and " << most;
    throw InvalidInput(with_value(name, value), reason.str(), advice);
}

void require_share(const std::string& name, const std::optional<double>& value) {
    if (value) require_within(name, *value, 0, 1, "give it as a share of full scale, such as 0.01");
}

void require_threshold(const CompareOptions& options) {
    if (!options.threshold) return;
    switch (deciding_metric(options)) {
        case DiffMetric::psnr:
            if (*options.threshold >= 0 && std::isfinite(*options.threshold)) return;
            throw InvalidInput(with_value("threshold", *options.threshold), "is not 0 or more",
                               "of psnr it is the least number of decibels, such as 40");
        case DiffMetric::ssim:
            return require_within("threshold", *options.threshold, 0, 1, "of ssim it is the least similarity");
        default: require_share("threshold", options.threshold);
    }
}

// Rules that weigh single pixels need a metric that tells of each pixel.
void require_pixel_metric(const CompareOptions& options) {
    const DiffMetric metric = deciding_metric(options);
    if (is_pixel_metric(metric)) return;
    const char* rule = options.fail_pixels    ? "fail-pixels"
                       : options.fail_percent ? "fail-percent"
                       : options.antialiasing ? "aa"
                                              : nullptr;
    if (!rule) return;
    throw InvalidInput(rule, "weighs single pixels, and the metric " + diff_metric_name(metric) + " the whole picture",
                       "use the metric max or flip");
}

}  // namespace

DiffMetric diff_metric_from_name(const std::string& name) {
    return static_cast<DiffMetric>(index_of(kMetricNames, name, "metric"));
}

std::string diff_metric_name(DiffMetric metric) {
    return std::string(kMetricNames[static_cast<std::size_t>(metric)]);
}

AlphaRule alpha_rule_from_name(const std::string& name) {
    return static_cast<AlphaRule>(index_of(kAlphaNames, name, "alpha"));
}

DiffMetric deciding_metric(const CompareOptions& options) {
    if (options.metric) return *options.metric;
    const bool pixels_count = options.threshold || options.fail_pixels || options.fail_percent || options.antialiasing;
    return options.min_ssim && !pixels_count ? DiffMetric::ssim : DiffMetric::max;
}

double metric_limit(const CompareOptions& options) {
    if (options.threshold) return *options.threshold;
    switch (deciding_metric(options)) {
        case DiffMetric::psnr: return std::numeric_limits<double>::infinity();
        case DiffMetric::ssim: return options.min_ssim.value_or(1);
        default: return 0;
    }
}

bool is_pixel_metric(DiffMetric metric) {
    return metric == DiffMetric::max || metric == DiffMetric::flip;
}

void require_sound(const CompareOptions& options) {
    require_threshold(options);
    require_share("hard-fail", options.hard_fail);
    require_share("window-threshold", options.window_threshold);
    if (options.min_ssim) require_within("min-ssim", *options.min_ssim, 0, 1, "1 is the same picture");
    if (options.fail_percent) require_within("fail-percent", *options.fail_percent, 0, 100, "");
    if (options.fail_pixels && *options.fail_pixels < 0) {
        throw InvalidInput("fail-pixels " + std::to_string(*options.fail_pixels), "is not 0 or more");
    }
    require_within("window", options.window_px, 0, kLargestWindow, "0 switches the rule off");
    require_within("shift", options.shift_px, 0, kLargestShift, "0 switches the search off");
    require_within("ppd", options.pixels_per_degree, 1, 1000, "a display half a metre away has about 40");
    require_pixel_metric(options);
    if (!options.mask.empty() && options.mask.type() != CV_8UC1) {
        throw InvalidInput("mask", "is not a grey picture of 8 bits");
    }
    for (const PixelRect& rect : options.ignore) {
        if (rect.width > 0 && rect.height > 0) continue;
        throw InvalidInput("ignore", "a rectangle is empty", "give it a width and a height of at least 1");
    }
}

}  // namespace puppetwarp
