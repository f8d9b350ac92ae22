#include <puppetwarp/diff/summary.h>

#include <puppetwarp/diff/telling_digits.h>

#include <cmath>
#include <ostream>
#include <sstream>

namespace puppetwarp {

namespace {

// Both have the channel whose values differ, which shall read differently too.
std::string values_phrase(const Comparison& comparison) {
    const std::vector<double>& expected = comparison.expected_at_max;
    const std::vector<double>& actual = comparison.actual_at_max;
    const auto channel = static_cast<std::size_t>(comparison.max_channel);
    std::ostringstream out;
    out.precision(telling_digits(expected[channel], actual[channel]));
    for (std::size_t i = 0; i < expected.size(); ++i) out << (i == 0 ? "" : ", ") << expected[i];
    out << " vs ";
    for (std::size_t i = 0; i < actual.size(); ++i) out << (i == 0 ? "" : ", ") << actual[i];
    return out.str();
}

// R, G, B, A; Y, A of grey.
char channel_letter(int channel, std::size_t channels) {
    if (channels < 3) return channel == 0 ? 'Y' : 'A';
    return "RGBA"[channel];
}

void print_figures(const Comparison& comparison, std::ostream& out) {
    out << "  Mean error = " << comparison.mean << "\n  RMS error = " << comparison.rmse
        << "\n  Peak SNR = " << comparison.psnr << "\n  Max error  = " << comparison.max << " @ (" << comparison.max_x
        << ", " << comparison.max_y << ") in "
        << channel_letter(comparison.max_channel, comparison.expected_at_max.size()) << "  values are "
        << values_phrase(comparison) << "\n  " << comparison.differing_pixels << " pixels ("
        << comparison.differing_percent << " %) " << (comparison.metric == DiffMetric::flip ? "seen " : "") << "over "
        << (is_pixel_metric(comparison.metric) ? comparison.threshold : 0) << '\n';
}

void print_more(const Comparison& comparison, std::ostream& out) {
    if (comparison.ssim) out << "  SSIM = " << *comparison.ssim << '\n';
    if (comparison.flip) {
        out << "  FLIP mean = " << *comparison.flip << ", max = " << comparison.flip_max;
        if (comparison.flip_max_x >= 0) {
            out << " @ (" << comparison.flip_max_x << ", " << comparison.flip_max_y << ')';
        }
        out << '\n';
    }
    if (comparison.antialiased_pixels > 0) {
        out << "  " << comparison.antialiased_pixels << " pixels tolerated as antialiased\n";
    }
    if (comparison.shift_x != 0 || comparison.shift_y != 0) {
        out << "  moved by (" << comparison.shift_x << ", " << comparison.shift_y << ")\n";
    }
}

}  // namespace

std::string summary(const Comparison& comparison) {
    std::ostringstream out;
    const bool differs = comparison.comparable && comparison.max_x >= 0;
    if (comparison.same) {
        out << (differs ? "same: within the limits" : "same") << '\n';
    } else {
        out << "different: " << comparison.reason << '\n';
    }
    if (differs) print_figures(comparison, out);
    if (comparison.comparable) print_more(comparison, out);
    return out.str();
}

}  // namespace puppetwarp
