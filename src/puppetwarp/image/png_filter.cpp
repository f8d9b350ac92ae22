#include <puppetwarp/image/png_filter.h>

#include <array>
#include <bit>
#include <cstdlib>
#include <cstring>
#include <utility>

namespace puppetwarp {

namespace {

// `previous` and `row` have one pixel of zeros in front, so that the leftmost pixel needs no case of its own.
struct RowPair {
    const std::uint8_t* previous;
    const std::uint8_t* row;
    std::size_t bytes;
    std::size_t pixel_bytes;
};

std::uint8_t paeth_predictor(int left, int up, int corner) {
    const int estimate = left + up - corner;
    const int to_left = std::abs(estimate - left);
    const int to_up = std::abs(estimate - up);
    const int to_corner = std::abs(estimate - corner);
    const int nearest = to_up <= to_corner ? up : corner;
    return static_cast<std::uint8_t>(to_left <= to_up && to_left <= to_corner ? left : nearest);
}

void apply(PngFilter filter, const RowPair& pair, std::uint8_t* out) {
    const std::uint8_t* left = pair.row - pair.pixel_bytes;
    const std::uint8_t* corner = pair.previous - pair.pixel_bytes;
    const auto each = [&](const auto& prediction) {
        for (std::size_t i = 0; i < pair.bytes; ++i) out[i] = static_cast<std::uint8_t>(pair.row[i] - prediction(i));
    };
    switch (filter) {
        case PngFilter::none: std::memcpy(out, pair.row, pair.bytes); return;
        case PngFilter::sub: each([&](std::size_t i) { return left[i]; }); return;
        case PngFilter::up: each([&](std::size_t i) { return pair.previous[i]; }); return;
        case PngFilter::average: each([&](std::size_t i) { return (left[i] + pair.previous[i]) / 2; }); return;
        case PngFilter::paeth:
            each([&](std::size_t i) { return paeth_predictor(left[i], pair.previous[i], corner[i]); });
            return;
    }
}

std::uint64_t cost(const std::uint8_t* bytes, std::size_t count) {
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < count; ++i)
        sum += static_cast<std::uint64_t>(std::abs(static_cast<std::int8_t>(bytes[i])));
    return sum;
}

}  // namespace

PngRowFilter::PngRowFilter(cv::Mat pixels, cv::Mat above)
    : pixels_(std::move(pixels)),
      above_(std::move(above)),
      row_bytes_(static_cast<std::size_t>(pixels_.cols) * pixels_.elemSize()),
      pixel_bytes_(pixels_.elemSize()) {}

// PNG holds 16-bit values with the high byte first.
void PngRowFilter::store_row(const std::uint8_t* row, std::uint8_t* bytes) const {
    if (pixels_.depth() == CV_8U || std::endian::native == std::endian::big) {
        std::memcpy(bytes, row, row_bytes_);
        return;
    }
    for (std::size_t i = 0; i < row_bytes_; i += 2) {
        bytes[i] = row[i + 1];
        bytes[i + 1] = row[i];
    }
}

std::vector<std::uint8_t> PngRowFilter::filtered(int first, int last, PngFilter filter) const {
    std::vector<std::uint8_t> out(static_cast<std::size_t>(last - first) * row_bytes());
    std::vector<std::uint8_t> previous(pixel_bytes_ + row_bytes_);
    std::vector<std::uint8_t> row(pixel_bytes_ + row_bytes_);
    if (first > 0 || !above_.empty())
        store_row(first > 0 ? pixels_.ptr(first - 1) : above_.ptr(), previous.data() + pixel_bytes_);
    std::uint8_t* to = out.data();
    for (int y = first; y < last; ++y, to += row_bytes()) {
        store_row(pixels_.ptr(y), row.data() + pixel_bytes_);
        to[0] = static_cast<std::uint8_t>(filter);
        apply(filter, {previous.data() + pixel_bytes_, row.data() + pixel_bytes_, row_bytes_, pixel_bytes_}, to + 1);
        std::swap(previous, row);
    }
    return out;
}

std::vector<std::uint8_t> PngRowFilter::filtered_adaptively(int first, int last) const {
    constexpr std::array all = {PngFilter::none, PngFilter::sub, PngFilter::up, PngFilter::average, PngFilter::paeth};
    std::vector<std::uint8_t> best;
    std::vector<std::uint64_t> best_costs;
    const std::size_t rows = static_cast<std::size_t>(last - first);
    for (const PngFilter filter : all) {
        std::vector<std::uint8_t> candidate = filtered(first, last, filter);
        if (best.empty()) {
            best = std::move(candidate);
            for (std::size_t i = 0; i < rows; ++i) best_costs.push_back(cost(&best[i * row_bytes() + 1], row_bytes_));
            continue;
        }
        for (std::size_t i = 0; i < rows; ++i) {
            const std::uint64_t candidate_cost = cost(&candidate[i * row_bytes() + 1], row_bytes_);
            if (candidate_cost >= best_costs[i]) continue;
            best_costs[i] = candidate_cost;
            std::memcpy(&best[i * row_bytes()], &candidate[i * row_bytes()], row_bytes());
        }
    }
    return best;
}

}  // namespace puppetwarp
