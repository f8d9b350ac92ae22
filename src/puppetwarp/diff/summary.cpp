#include <puppetwarp/diff/summary.h>

#include <cmath>
#include <ostream>
#include <sstream>

namespace puppetwarp {

namespace {

void print_values(const std::vector<double>& values, std::ostream& out) {
    for (std::size_t i = 0; i < values.size(); ++i) out << (i == 0 ? "" : ", ") << values[i];
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
        << channel_letter(comparison.max_channel, comparison.expected_at_max.size()) << "  values are ";
    print_values(comparison.expected_at_max, out);
    out << " vs ";
    print_values(comparison.actual_at_max, out);
    out << "\n  " << comparison.differing_pixels << " pixels (" << comparison.differing_percent << " %) "
        << (comparison.metric == DiffMetric::flip ? "seen " : "") << "over "
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
