#include <puppetwarp/cutout/patch_field.h>

#include <puppetwarp/base/threads.h>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

namespace puppetwarp {

namespace {

constexpr int rows_a_task = 8;
constexpr int side = 2 * PatchField::radius + 1;
constexpr int most_trust = 16;
constexpr double trust_falls_to = 1 / 1.3;  // a pixel deeper
// Sources lie within this share of a pixel's depth, and a few pixels more.
constexpr double reach_share = 1.8;
constexpr double least_reach_px = 12;
constexpr double alike_levels = 8;  // of 255: patches that differ by this root of mean squares still say much
constexpr double least_likeness = 1e-6;
constexpr float most_lacking = 16.0F / 255;  // what differs more beside the hole is another thing, not a seam

using Offset = cv::Vec2s;

// A number that looks random, for each pixel, pass and candidate the same on every run.
std::uint32_t scrambled(std::uint32_t x) {
    x = (x ^ (x >> 16)) * 0x7feb352dU;
    x = (x ^ (x >> 15)) * 0x846ca68bU;
    return x ^ (x >> 16);
}

cv::Mat grown(const cv::Mat& mask, int by) {
    cv::Mat result;
    cv::dilate(mask, result, cv::Mat::ones(2 * by + 1, 2 * by + 1, CV_8U));
    return result;
}

// Keeps only what lies at least `by` from the border.
void clear_border(cv::Mat& mask, int by) {
    if (mask.rows <= 2 * by || mask.cols <= 2 * by) {
        mask.setTo(0);
        return;
    }
    mask.rowRange(0, by).setTo(0);
    mask.rowRange(mask.rows - by, mask.rows).setTo(0);
    mask.colRange(0, by).setTo(0);
    mask.colRange(mask.cols - by, mask.cols).setTo(0);
}

// From each pixel to the nearest one of a mask that is not empty.
cv::Mat offsets_to_nearest(const cv::Mat& mask) {
    cv::Mat distance, label;
    cv::distanceTransform(mask == 0, distance, label, cv::DIST_L2, cv::DIST_MASK_5, cv::DIST_LABEL_PIXEL);
    std::vector<cv::Point> place(1);
    for (int y = 0; y < mask.rows; ++y) {
        for (int x = 0; x < mask.cols; ++x) {
            if (mask.at<std::uint8_t>(y, x) == 0) continue;
            const auto index = static_cast<std::size_t>(label.at<int>(y, x));
            if (place.size() <= index) place.resize(index + 1);
            place[index] = {x, y};
        }
    }
    cv::Mat offset(mask.size(), CV_16SC2);
    for (int y = 0; y < mask.rows; ++y) {
        for (int x = 0; x < mask.cols; ++x) {
            const cv::Point& p = place[static_cast<std::size_t>(label.at<int>(y, x))];
            offset.at<Offset>(y, x) = {static_cast<short>(p.x - x), static_cast<short>(p.y - y)};
        }
    }
    return offset;
}

}  // namespace

// Compares patches, in whole numbers, so that sums may be taken in any order.
template <int Channels>
class PatchField::Matcher {
public:
    Matcher(PatchField& field, const cv::Mat& picture) : field_(field) {
        picture.convertTo(levels_, CV_MAKETYPE(CV_16S, Channels), 255);
        cv::max(levels_, 0, levels_);
        cv::min(levels_, 255, levels_);
        trust_.create(levels_.size(), CV_MAKETYPE(CV_16S, Channels));
        cv::merge(std::vector<cv::Mat>(Channels, field.trust_), trust_);
    }

    // Weighted sum of squared differences of the patches at a and b; or something above `most`.
    int cost(int ax, int ay, int bx, int by, int most) const {
        int sum = 0;
        for (int dy = -radius; dy <= radius && sum <= most; ++dy) {
            const short* a = levels_.ptr<short>(ay + dy) + Channels * (ax - radius);
            const short* b = levels_.ptr<short>(by + dy) + Channels * (bx - radius);
            const short* w = trust_.ptr<short>(ay + dy) + Channels * (ax - radius);
            int row = 0;
            for (int i = 0; i < side * Channels; ++i) row += w[i] * (a[i] - b[i]) * (a[i] - b[i]);
            sum += row;
        }
        return sum;
    }

    void measure_all() {
        for_targets([&](int x, int y) {
            const Offset o = field_.offset_.at<Offset>(y, x);
            field_.cost_.at<int>(y, x) = cost(x, y, x + o[0], y + o[1], std::numeric_limits<int>::max());
        });
    }

    // \param step  how far the neighbours are that are asked.
    void pass(int step, std::uint32_t number, int random_reach_px) {
        cv::Mat offset = field_.offset_.clone(), cost_now = field_.cost_.clone();
        for_targets([&](int x, int y) {
            Best best{field_.offset_.at<Offset>(y, x), field_.cost_.at<int>(y, x)};
            constexpr std::array<std::array<int, 2>, 4> ways{{{1, 0}, {-1, 0}, {0, 1}, {0, -1}}};
            for (const auto& way : ways) {
                const int nx = x + way[0] * step, ny = y + way[1] * step;
                if (field_.is_target(nx, ny)) consider(x, y, field_.offset_.at<Offset>(ny, nx), best);
            }
            std::uint32_t random = scrambled(static_cast<std::uint32_t>(y * levels_.cols + x) ^ scrambled(number));
            const int reach = std::min(random_reach_px, static_cast<int>(reach_of(x, y)));
            for (int r = reach; r >= 1; r /= 2) {
                const auto near = [&] {
                    random = scrambled(random + 1);
                    return static_cast<int>(random % static_cast<std::uint32_t>(2 * r + 1)) - r;
                };
                const int dx = near(), dy = near();
                consider(x, y, best.offset + Offset(static_cast<short>(dx), static_cast<short>(dy)), best);
            }
            offset.at<Offset>(y, x) = best.offset;
            cost_now.at<int>(y, x) = best.cost;
        });
        field_.offset_ = offset;
        field_.cost_ = cost_now;
    }

private:
    struct Best {
        Offset offset;
        int cost;
    };

    double reach_of(int x, int y) const { return reach_share * field_.depth_.at<float>(y, x) + least_reach_px; }

    void consider(int x, int y, const Offset& offset, Best& best) const {
        if (offset == best.offset || !field_.is_source(x + offset[0], y + offset[1])) return;
        const double reach = reach_of(x, y);
        if (offset[0] * offset[0] + offset[1] * offset[1] > reach * reach) return;
        const int found = cost(x, y, x + offset[0], y + offset[1], best.cost);
        if (found < best.cost) best = {offset, found};
    }

    template <class Body>
    void for_targets(const Body& body) const {
        parallel_for(0, levels_.rows, rows_a_task, [&](int first, int last) {
            for (int y = first; y < last; ++y) {
                const std::uint8_t* target = field_.target_.template ptr<std::uint8_t>(y);
                for (int x = 0; x < levels_.cols; ++x) {
                    if (target[x] != 0) body(x, y);
                }
            }
        });
    }

    PatchField& field_;
    cv::Mat levels_;  // CV_16S, 0 to 255
    cv::Mat trust_;   // the field's, once a channel
};

PatchField::PatchField(const cv::Mat& hole, const cv::Mat& depth)
    : hole_(hole), depth_(depth), trust_(hole.size(), CV_16S) {
    source_ = grown(hole, radius) == 0;
    clear_border(source_, radius);
    target_ = grown(hole, radius);
    clear_border(target_, radius);
    std::vector<short> trust_at;
    for (double trust = most_trust; trust >= 1; trust *= trust_falls_to) {
        trust_at.push_back(static_cast<short>(std::lround(trust)));
    }
    for (int y = 0; y < hole.rows; ++y) {
        for (int x = 0; x < hole.cols; ++x) {
            const auto d = static_cast<std::size_t>(depth.at<float>(y, x) + 0.5F);
            trust_.at<short>(y, x) = trust_at[std::min(d, trust_at.size() - 1)];
        }
    }
    offset_ = cv::Mat(hole.size(), CV_16SC2, cv::Scalar::all(0));
    cost_ = cv::Mat(hole.size(), CV_32S, cv::Scalar(0));
}

bool PatchField::begin() {
    if (cv::countNonZero(source_) == 0) return false;
    offset_ = offsets_to_nearest(source_);
    return true;
}

bool PatchField::begin(const PatchField& coarse) {
    const auto middle = [](int i, int size) { return std::clamp(i / 2, radius, std::max(radius, size - 1 - radius)); };
    for (int y = 0; y < hole_.rows; ++y) {
        const int coarse_y = middle(y, coarse.hole_.rows);
        for (int x = 0; x < hole_.cols; ++x) {
            std::uint8_t& target = target_.at<std::uint8_t>(y, x);
            if (target == 0) continue;
            const int coarse_x = middle(x, coarse.hole_.cols);
            target = 0;
            if (!coarse.is_target(coarse_x, coarse_y)) continue;
            const Offset half = coarse.offset_.at<Offset>(coarse_y, coarse_x);
            if (!is_source(x + 2 * half[0], y + 2 * half[1])) continue;
            offset_.at<Offset>(y, x) = {static_cast<short>(2 * half[0]), static_cast<short>(2 * half[1])};
            target = 255;
        }
    }
    return true;
}

void PatchField::improve(const cv::Mat& picture, std::span<const int> passes, int random_reach_px, std::uint32_t seed) {
    const auto run = [&](auto matcher) {
        matcher.measure_all();
        for (const int step : passes) matcher.pass(step, seed++, random_reach_px);
    };
    switch (picture.channels()) {
        case 1: return run(Matcher<1>(*this, picture));
        case 2: return run(Matcher<2>(*this, picture));
        case 3: return run(Matcher<3>(*this, picture));
        default: return run(Matcher<4>(*this, picture));
    }
}

// How much each target's patch counts.
cv::Mat PatchField::votes(int channels) const {
    const double alike = most_trust * side * side * channels * 2 * alike_levels * alike_levels;
    cv::Mat votes(hole_.size(), CV_32F, cv::Scalar(0));
    parallel_for(0, hole_.rows, rows_a_task, [&](int first, int last) {
        for (int y = first; y < last; ++y) {
            for (int x = 0; x < hole_.cols; ++x) {
                if (!is_target(x, y)) continue;
                const double likeness = std::exp(-cost_.at<int>(y, x) / alike) + least_likeness;
                votes.at<float>(y, x) = static_cast<float>(trust_.at<short>(y, x) * likeness);
            }
        }
    });
    return votes;
}

void PatchField::vote(cv::Mat& picture) const {
    const cv::Mat weight = votes(picture.channels());
    // Only sources are read and only the hole is written: in place.
    parallel_for(0, picture.rows, rows_a_task, [&](int first, int last) {
        for (int y = first; y < last; ++y) {
            for (int x = 0; x < picture.cols; ++x) {
                if (hole_.at<std::uint8_t>(y, x) == 0) continue;
                vote_at(x, y, weight, picture, picture.ptr<float>(y) + picture.channels() * x);
            }
        }
    });
}

cv::Mat PatchField::mismatch(int channels) const {
    cv::Mat trust, result(hole_.size(), CV_32F, cv::Scalar(0));
    trust_.convertTo(trust, CV_32F, channels);
    cv::boxFilter(trust, trust, CV_32F, {side, side}, {-1, -1}, false);
    for (int y = 0; y < hole_.rows; ++y) {
        for (int x = 0; x < hole_.cols; ++x) {
            if (!is_target(x, y)) continue;
            result.at<float>(y, x) = std::sqrt(static_cast<float>(cost_.at<int>(y, x)) / trust.at<float>(y, x)) / 255;
        }
    }
    cv::boxFilter(result, result, CV_32F, {side, side});
    return result;
}

// \return false, and nothing written, where no patch says anything.
bool PatchField::vote_at(int x, int y, const cv::Mat& weight, const cv::Mat& picture, float* out) const {
    const int channels = picture.channels();
    std::array<float, 4> sum{};
    float weights = 0;
    for (int py = std::max(0, y - radius); py <= std::min(picture.rows - 1, y + radius); ++py) {
        const float* w = weight.ptr<float>(py);
        for (int px = std::max(0, x - radius); px <= std::min(picture.cols - 1, x + radius); ++px) {
            if (!(w[px] > 0)) continue;
            const Offset o = offset_.at<Offset>(py, px);
            const float* source = picture.ptr<float>(y + o[1]) + channels * (x + o[0]);
            for (int c = 0; c < channels; ++c) sum[static_cast<std::size_t>(c)] += w[px] * source[c];
            weights += w[px];
        }
    }
    if (!(weights > 0)) return false;
    for (int c = 0; c < channels; ++c) out[c] = sum[static_cast<std::size_t>(c)] / weights;
    return true;
}

cv::Mat PatchField::seam(const cv::Mat& picture, int cell_px, cv::Mat& known) const {
    const int channels = picture.channels();
    const cv::Size size((picture.cols - 1) / cell_px + 1, (picture.rows - 1) / cell_px + 1);
    cv::Mat sum(size, picture.type(), cv::Scalar::all(0)), count(size, CV_32F, cv::Scalar(0));
    const cv::Mat weight = votes(channels), edge = (hole_ == 0) & grown(hole_, 1);
    for (int y = 0; y < picture.rows; ++y) {
        for (int x = 0; x < picture.cols; ++x) {
            std::array<float, 4> said{};
            if (edge.at<std::uint8_t>(y, x) == 0 || !vote_at(x, y, weight, picture, said.data())) continue;
            const float* is = picture.ptr<float>(y) + channels * x;
            float most = 0;
            for (int c = 0; c < channels; ++c) {
                float& lacking = said[static_cast<std::size_t>(c)];
                lacking = is[c] - lacking;
                most = std::max(most, std::abs(lacking));
            }
            if (most > most_lacking) continue;
            float* cell = sum.ptr<float>(y / cell_px) + channels * (x / cell_px);
            for (int c = 0; c < channels; ++c) cell[c] += said[static_cast<std::size_t>(c)];
            count.at<float>(y / cell_px, x / cell_px) += 1;
        }
    }
    known = count > 0;
    cv::Mat counts;
    cv::merge(std::vector<cv::Mat>(static_cast<std::size_t>(channels), cv::max(count, 1)), counts);
    return sum / counts;
}

}  // namespace puppetwarp
