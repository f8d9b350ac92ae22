#include "diff_options.h"

#include "options.h"

#include <puppetwarp/base/errors.h>
#include <puppetwarp/diff/mask.h>

#include <charconv>
#include <string_view>

namespace puppetwarp::cli {

namespace {

std::optional<double> share(const std::optional<std::string>& text, const std::string& option) {
    if (!text) return std::nullopt;
    return parse_share(*text, option);
}

// Decibels may be over 1; all other limits are shares.
std::optional<double> limit(const std::optional<std::string>& text, const std::optional<DiffMetric>& metric) {
    if (text && metric == DiffMetric::psnr) return parse_number(*text, "--threshold");
    return share(text, "--threshold");
}

PixelRect parse_rect(const std::string& text) {
    PixelRect rect;
    const char* next = text.data();
    const char* const end = next + text.size();
    bool sound = true;
    for (int* value : {&rect.x, &rect.y, &rect.width, &rect.height}) {
        if (value != &rect.x) sound = sound && next != end && *next++ == ',';
        if (!sound) break;
        const auto [after, error] = std::from_chars(next, end, *value);
        sound = error == std::errc();
        next = after;
    }
    if (sound && next == end && rect.width > 0 && rect.height > 0) return rect;
    throw InvalidInput("--ignore " + text, "is not a rectangle of whole pixels",
                       "write X,Y,W,H: its upper left corner, its width and its height");
}

void add_limits(CLI::App& diff, DiffOptions& options) {
    diff.add_option("--threshold", options.threshold,
                    "The limit of the metric. max, flip: a pixel differs when it is off by more, 0 to 1 or as 4/255. "
                    "rmse: the most it may be. psnr, ssim: the least, decibels and 0 to 1 (default: no difference)")
        ->type_name("T");
    diff.add_option("--metric", options.metric,
                    "What decides. Pixel by pixel: max, the largest difference of a channel (default), flip, the "
                    "difference a person sees. Of the whole picture: rmse, psnr, ssim")
        ->type_name("M")
        ->check(CLI::IsMember({"max", "rmse", "psnr", "ssim", "flip"}));
    diff.add_option("--fail-pixels", options.fail_pixels, "max, flip: fail when more than N pixels differ (default 0)")
        ->type_name("N");
    diff.add_option("--fail-percent", options.fail_percent, "max, flip: fail when more than P percent of them differ")
        ->type_name("P");
    diff.add_option("--hard-fail", options.hard_fail,
                    "Fail when one channel of one pixel is off by more than T, whatever else is tolerated")
        ->type_name("T");
    diff.add_option("--min-ssim", options.min_ssim,
                    "Fail when the structural similarity of luma is under S, 0 to 1; without --metric, --threshold and "
                    "other rules for pixels it alone decides")
        ->type_name("S");
    diff.add_option("--ppd", options.pixels_per_degree,
                    "flip: pixels in a degree of the observer's view (default 67.02: 0.7 m from a 4K display)")
        ->type_name("N");
}

void add_tolerances(CLI::App& diff, DiffOptions& options) {
    diff.add_flag("--aa", options.antialiasing, "max, flip: tolerate pixels that look antialiased");
    diff.add_option("--window", options.window_px,
                    "Fail when N or more pixels of a square of N x N are off at all, as along a seam, however little "
                    "and however few in all")
        ->type_name("N");
    diff.add_option("--window-threshold", options.window_threshold,
                    "What --window counts: pixels off by more than T (default 0)")
        ->type_name("T");
    diff.add_option("--shift", options.shift_px,
                    "Compare where the pictures fit best, moved by up to N pixels, and only what both have then")
        ->type_name("N");
    diff.add_option("--mask", options.mask, "Compare only where this picture of the same size is white")
        ->type_name("FILE")
        ->check(not_empty());
    diff.add_option("--ignore", options.ignore, "Do not compare this rectangle; again for more")
        ->type_name("X,Y,W,H")
        ->allow_extra_args(false);
    diff.add_option("--alpha", options.alpha,
                    "straight: colours as stored, also where invisible (default); premultiplied; ignore: not at all")
        ->type_name("A")
        ->check(CLI::IsMember({"straight", "premultiplied", "ignore"}));
    diff.add_flag("--metadata", options.metadata,
                  "Differing ICC profile, orientation, EXIF, XMP or resolution fails too");
    diff.add_option("--max-pixels", options.max_pixels, "Refuse larger pictures (default 200000000)")
        ->type_name("N")
        ->check(above_zero());
}

}  // namespace

void DiffOptions::add_to(CLI::App& diff) {
    add_limits(diff, *this);
    add_tolerances(diff, *this);
}

CompareOptions DiffOptions::compare_options() const {
    CompareOptions result;
    if (metric) result.metric = diff_metric_from_name(*metric);
    result.threshold = limit(threshold, result.metric);
    result.fail_pixels = fail_pixels;
    result.fail_percent = fail_percent;
    result.hard_fail = share(hard_fail, "--hard-fail");
    result.min_ssim = share(min_ssim, "--min-ssim");
    result.antialiasing = antialiasing;
    result.window_px = window_px;
    result.window_threshold = share(window_threshold, "--window-threshold").value_or(0);
    if (window_threshold && window_px == 0) {
        throw InvalidInput("--window-threshold", "says what --window counts", "give --window N too");
    }
    result.shift_px = shift_px;
    for (const std::string& rect : ignore) result.ignore.push_back(parse_rect(rect));
    result.alpha = alpha_rule_from_name(alpha);
    if (pixels_per_degree) {
        if (deciding_metric(result) != DiffMetric::flip) {
            throw InvalidInput("--ppd", "says from how far away flip sees", "give --metric flip too");
        }
        result.pixels_per_degree = *pixels_per_degree;
    }
    result.metadata = metadata;
    require_sound(result);
    if (!mask.empty()) result.mask = comparison_mask(read_image(mask, reading()));
    return result;
}

}  // namespace puppetwarp::cli
