#include <puppetwarp/diff/verdict.h>

#include <puppetwarp/diff/telling_digits.h>

#include <algorithm>
#include <sstream>
#include <string>

namespace puppetwarp {

namespace {

class Verdict {
public:
    explicit Verdict(Comparison& comparison) : comparison_(comparison) {}

    void fail(const std::string& rule, const std::string& reason) {
        comparison_.same = false;
        if (comparison_.failed.empty() || comparison_.failed.back() != rule) comparison_.failed.push_back(rule);
        if (reason.empty()) return;
        comparison_.reason += (comparison_.reason.empty() ? "" : "; ") + reason;
    }

private:
    Comparison& comparison_;
};

// "12 pixels differ (0.5 %), by up to 0.25 of full scale at 30,40"
std::string pixels_reason(const Comparison& comparison, int digits) {
    const bool flip = comparison.metric == DiffMetric::flip;
    std::ostringstream reason;
    reason.precision(
        std::max(digits, telling_digits(flip ? comparison.flip_max : comparison.max, comparison.threshold)));
    reason << comparison.differing_pixels << (comparison.differing_pixels == 1 ? " pixel differs" : " pixels differ");
    if (flip) reason << " to the eye";
    if (comparison.threshold > 0) reason << " by more than " << comparison.threshold;
    reason << " (" << comparison.differing_percent << " %)";
    if (flip) {
        reason << ", FLIP up to " << comparison.flip_max << " at " << comparison.flip_max_x << ','
               << comparison.flip_max_y;
    } else {
        reason << ", by up to " << comparison.max << " of full scale at " << comparison.max_x << ','
               << comparison.max_y;
    }
    return reason.str();
}

void judge_pixels(const CompareOptions& options, const Comparison& comparison, Verdict& verdict) {
    if (!options.fail_pixels && !options.fail_percent) {
        if (comparison.differing_pixels > 0) verdict.fail("threshold", pixels_reason(comparison, 0));
        return;
    }
    const bool pixels = options.fail_pixels && comparison.differing_pixels > *options.fail_pixels;
    const bool percent = options.fail_percent && comparison.differing_percent > *options.fail_percent;
    if (!pixels && !percent) return;
    const int digits = percent ? telling_digits(comparison.differing_percent, *options.fail_percent) : 0;
    std::ostringstream reason;
    if (percent) reason.precision(digits);
    reason << pixels_reason(comparison, digits) << "; allowed ";
    if (pixels) reason << (*options.fail_pixels == 1 ? "is " : "are ") << *options.fail_pixels;
    if (pixels && percent) reason << " and ";
    if (percent) reason << (pixels ? "" : "are ") << *options.fail_percent << " %";
    if (pixels) verdict.fail("fail-pixels", reason.str());
    if (percent) verdict.fail("fail-percent", pixels ? "" : reason.str());
}

std::string against_limit(const std::string& what, double value, const char* side, double limit) {
    std::ostringstream reason;
    reason.precision(telling_digits(value, limit));
    reason << what << " is " << value << ", " << side << " the limit of " << limit;
    return reason.str();
}

void judge_ssim(const CompareOptions& options, const Comparison& comparison, Verdict& verdict) {
    const double value = comparison.ssim.value_or(0);
    if (value < comparison.threshold) {
        verdict.fail("threshold", against_limit("SSIM", value, "under", comparison.threshold));
    } else if (!options.threshold && comparison.max_x >= 0) {
        // Without a limit nothing may differ: neither colours of one luma, nor by so little that SSIM is rounded to 1.
        std::ostringstream reason;
        reason << "SSIM is 1, but a pixel differs by " << comparison.max << " of full scale at " << comparison.max_x
               << ',' << comparison.max_y;
        verdict.fail("threshold", reason.str());
    }
}

void judge_metric(const CompareOptions& options, const Comparison& comparison, Verdict& verdict) {
    const double limit = comparison.threshold;
    switch (comparison.metric) {
        case DiffMetric::rmse:
            if (comparison.rmse > limit) {
                verdict.fail("threshold", against_limit("the RMS error", comparison.rmse, "over", limit));
            }
            break;
        case DiffMetric::psnr:
            if (comparison.psnr < limit) {
                verdict.fail("threshold", against_limit("the peak SNR", comparison.psnr, "under", limit) + " dB");
            }
            break;
        case DiffMetric::ssim:
            // Set by --min-ssim alone, the limit is that rule's.
            if (options.threshold || !options.min_ssim) judge_ssim(options, comparison, verdict);
            break;
        default: judge_pixels(options, comparison, verdict);
    }
}

void judge_more(const CompareOptions& options, const Comparison& comparison, Verdict& verdict) {
    if (options.min_ssim && comparison.ssim.value_or(0) < *options.min_ssim) {
        verdict.fail("min-ssim", against_limit("SSIM", comparison.ssim.value_or(0), "under", *options.min_ssim));
    }
    if (options.hard_fail && comparison.max > *options.hard_fail) {
        std::ostringstream reason;
        reason.precision(telling_digits(comparison.max, *options.hard_fail));
        reason << "a pixel differs by " << comparison.max << " of full scale at " << comparison.max_x << ','
               << comparison.max_y << ", over the hard limit of " << *options.hard_fail;
        verdict.fail("hard-fail", reason.str());
    }
    if (options.window_px > 0 && comparison.window_pixels >= options.window_px) {
        std::ostringstream reason;
        reason << comparison.window_pixels << " pixels differ close together, within " << options.window_px << " x "
               << options.window_px << " at " << comparison.window_x << ',' << comparison.window_y;
        verdict.fail("window", reason.str());
    }
}

}  // namespace

void judge(const Incomparable& incomparable, const CompareOptions& options, Comparison& comparison) {
    Verdict verdict(comparison);
    if (!comparison.comparable) {
        verdict.fail(incomparable.rule, incomparable.reason);
    } else {
        judge_metric(options, comparison, verdict);
        judge_more(options, comparison, verdict);
    }
    for (const std::string& difference : comparison.metadata) verdict.fail("metadata", difference);
}

void fail_metadata(const std::string& difference, Comparison& comparison) {
    comparison.metadata.push_back(difference);
    Verdict(comparison).fail("metadata", difference);
}

}  // namespace puppetwarp
