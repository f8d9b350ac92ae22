#include <puppetwarp/cutout/enlarge_filling.h>

#include <puppetwarp/base/threads.h>
#include <puppetwarp/cutout/full_scale.h>

#include <opencv2/core.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>

namespace puppetwarp {

namespace {

constexpr int rows_a_task = 8;
constexpr int rows_between_reports = 128;
constexpr int samples_along = 6;       // of a patch that is compared, and
constexpr double compared_blocks = 3;  // how many blocks these span
constexpr double clearly = 0.75;       // a place fits better when the squared difference falls to this share

using Pixel = std::array<float, 4>;

template <class T>
class Enlarger {
public:
    Enlarger(const HoleFilling& filling, const cv::Mat& smaller, int halvings, const cv::Mat& hole, cv::Mat& pixels)
        : filling_(filling),
          smaller_(smaller, halvings),
          finish_(filling.empty() ? std::nullopt : std::make_optional<FillingFinish>(filling, halvings)),
          block_(1 << halvings),
          hole_(hole),
          pixels_(pixels),
          channels_(pixels.channels()) {}

    void fill(Progress& progress) {
        if (!filling_.empty()) find_places(progress);
        in_rows(hole_.rows, progress, 0.5, [&](int y) {
            for (int x = 0; x < hole_.cols; ++x) {
                if (!is_known(x, y)) fill_pixel(x, y);
            }
        });
    }

private:
    // Known pixels are read and others written: in place, in any order.
    template <class Body>
    static void in_rows(int rows, Progress& progress, double begun, const Body& body) {
        for (int first = 0; first < rows; first += rows_between_reports) {
            progress.step("background", begun + 0.5 * first / rows);
            parallel_for(first, std::min(rows, first + rows_between_reports), rows_a_task, [&](int begin, int end) {
                for (int y = begin; y < end; ++y) body(y);
            });
        }
    }

    bool is_known(int x, int y) const { return hole_.at<std::uint8_t>(y, x) == 0; }
    bool is_known_inside(int x, int y) const {
        return x >= 0 && y >= 0 && x < hole_.cols && y < hole_.rows && is_known(x, y);
    }
    Pixel load(int x, int y) const {
        Pixel pixel{};
        Values<T>::load(pixels_.ptr<T>(y) + channels_ * x, channels_, pixel.data());
        return pixel;
    }

    // From each block to its source, to the pixel: where what is there looks most like what is here.
    void find_places(Progress& progress) {
        places_.create(filling_.offset.size(), CV_32SC2);
        in_rows(places_.rows, progress, 0, [&](int y) {
            for (int x = 0; x < places_.cols; ++x) {
                if (filling_.weight.at<float>(y, x) > 0) places_.at<cv::Vec2i>(y, x) = place_of(x, y);
            }
        });
    }

    cv::Vec2i place_of(int block_x, int block_y) const {
        const auto small = filling_.offset.at<cv::Vec2s>(block_y, block_x);
        const cv::Vec2i whole(block_ * small[0], block_ * small[1]);
        const Samples samples = samples_at(block_x, block_y);
        const double unmoved = difference(samples, whole, std::numeric_limits<double>::infinity());
        // Unmoved unless that is clearly worse, so that neighbours stay together where there is little to tell.
        cv::Vec2i best = whole;
        double least = clearly * unmoved;
        for (int step = block_ / 2; step >= 1; step /= 2) {
            const cv::Vec2i middle = best;
            for (int dy = -step; dy <= step; dy += step) {
                for (int dx = -step; dx <= step; dx += step) {
                    const cv::Vec2i place = middle + cv::Vec2i(dx, dy);
                    const double found = place == middle ? least : difference(samples, place, least);
                    if (found >= least) continue;
                    least = found;
                    best = place;
                }
            }
        }
        return best;
    }

    // What is around a block: known pixels, and what the smaller picture was filled with.
    struct Samples {
        std::array<cv::Point, samples_along * samples_along> at;
        std::array<Pixel, samples_along * samples_along> value;
        std::size_t count = 0;
    };
    Samples samples_at(int block_x, int block_y) const {
        Samples samples;
        for (int j = 0; j < samples_along; ++j) {
            for (int i = 0; i < samples_along; ++i) {
                const auto along = [&](int block, int k) {
                    const double share = static_cast<double>(k) / (samples_along - 1) - 0.5;
                    return static_cast<int>(block_ * (block + 0.5 + compared_blocks * share));
                };
                const int x = along(block_x, i), y = along(block_y, j);
                if (x < 0 || y < 0 || x >= hole_.cols || y >= hole_.rows) continue;
                Pixel value{};
                if (is_known(x, y)) {
                    value = load(x, y);
                } else {
                    smaller_.read(x, y, value.data());
                }
                samples.at[samples.count] = {x, y};
                samples.value[samples.count++] = value;
            }
        }
        return samples;
    }

    // Sum of squared differences, or something not below `most`.
    double difference(const Samples& samples, const cv::Vec2i& offset, double most) const {
        double sum = 0;
        for (std::size_t i = 0; i < samples.count && sum < most; ++i) {
            const int x = samples.at[i].x + offset[0], y = samples.at[i].y + offset[1];
            if (!is_known_inside(x, y)) return std::numeric_limits<double>::infinity();
            const Pixel there = load(x, y);
            for (std::size_t c = 0; c < there.size(); ++c) {
                const auto d = static_cast<double>(there[c] - samples.value[i][c]);
                sum += d * d;
            }
        }
        return sum;
    }

    void fill_pixel(int x, int y) {
        Pixel pixel{};
        if (!filling_.empty() && vote(x, y, pixel)) {
            finish_->apply(x, y, channels_, pixel.data());
        } else {
            smaller_.read(x, y, pixel.data());
        }
        Values<T>::store(pixel.data(), channels_, pixels_.ptr<T>(y) + channels_ * x);
    }

    // The mean of what the four nearest blocks say. \return false when none does.
    bool vote(int x, int y, Pixel& mean) const {
        const double u = (x + 0.5) / block_ - 0.5, v = (y + 0.5) / block_ - 0.5;
        const int left = static_cast<int>(std::floor(u)), top = static_cast<int>(std::floor(v));
        float weights = 0;
        for (int j = top; j <= top + 1; ++j) {
            for (int i = left; i <= left + 1; ++i) {
                if (i < 0 || j < 0 || i >= places_.cols || j >= places_.rows) continue;
                const auto share = static_cast<float>((1 - std::abs(u - i)) * (1 - std::abs(v - j)));
                const float weight = share * filling_.weight.at<float>(j, i);
                if (!(weight > 0)) continue;
                const auto& place = places_.at<cv::Vec2i>(j, i);
                if (!is_known_inside(x + place[0], y + place[1])) continue;
                const Pixel there = load(x + place[0], y + place[1]);
                for (std::size_t c = 0; c < there.size(); ++c) mean[c] += weight * there[c];
                weights += weight;
            }
        }
        if (!(weights > 0)) return false;
        for (float& value : mean) value /= weights;
        return true;
    }

    const HoleFilling& filling_;
    Enlarged smaller_;
    std::optional<FillingFinish> finish_;
    int block_;
    const cv::Mat& hole_;
    cv::Mat& pixels_;
    int channels_;
    cv::Mat places_;  // CV_32SC2, in pixels of the larger picture
};

}  // namespace

void enlarge_filling(const HoleFilling& filling, const cv::Mat& smaller, int halvings, const cv::Mat& hole,
                     cv::Mat& pixels, Progress& progress) {
    switch (pixels.depth()) {
        case CV_8U: return Enlarger<std::uint8_t>(filling, smaller, halvings, hole, pixels).fill(progress);
        case CV_16U: return Enlarger<std::uint16_t>(filling, smaller, halvings, hole, pixels).fill(progress);
        default: return Enlarger<float>(filling, smaller, halvings, hole, pixels).fill(progress);
    }
}

}  // namespace puppetwarp
