#include <puppetwarp/cutout/exemplar_fill.h>

#include <puppetwarp/base/threads.h>
#include <puppetwarp/cutout/membrane.h>
#include <puppetwarp/cutout/patch_field.h>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

namespace puppetwarp {

namespace {

constexpr int rows_a_task = 32;
constexpr int shortest_side = 24;         // of the coarsest picture
constexpr double least_depth_px = 28;     // of its hole: patches that are large beside it would copy whole things
constexpr int searched_pixels = 120'000;  // holes up to here are searched in full; in finer pictures patches follow
constexpr int rounds = 5;                 // of searching and voting
constexpr int first_rounds = 12;          // the same where there is nothing to begin with
constexpr int anywhere_px = 1 << 14;
constexpr int least_seam_halvings = 2;  // a few pixels together tell what a seam lacks

// Patches that differ from what is around them by this root of mean squares do not fit; from a share of it on they
// fade.
constexpr double most_mismatch = 0.1;
constexpr double good_share = 0.6;

struct Level {
    cv::Mat picture;
    cv::Mat hole;
    cv::Mat depth;  // CV_32F: how far each pixel is from what is known
    double deepest = 0;
    std::unique_ptr<PatchField> field;
};

// How well patches fit, and what stands in where they do not, in a picture that is 2^halvings times smaller.
struct Substitute {
    cv::Mat mismatch;
    cv::Mat smooth;
    int halvings = 0;
};

void measure(Level& level) {
    cv::distanceTransform(level.hole, level.depth, cv::DIST_L2, cv::DIST_MASK_5);
    cv::minMaxLoc(level.depth, nullptr, &level.deepest);
}

// Half the size. What is not known of one of four pixels is not known.
Level halved(const Level& fine) {
    const int channels = fine.picture.channels();
    const cv::Size size((fine.hole.cols + 1) / 2, (fine.hole.rows + 1) / 2);
    Level coarse;
    coarse.picture = cv::Mat(size, fine.picture.type(), cv::Scalar::all(0));
    coarse.hole = cv::Mat(size, CV_8U, cv::Scalar(0));
    parallel_for(0, size.height, rows_a_task, [&](int first, int last) {
        for (int y = first; y < last; ++y) {
            const int rows[2] = {2 * y, std::min(2 * y + 1, fine.hole.rows - 1)};
            for (int x = 0; x < size.width; ++x) {
                const int columns[2] = {2 * x, std::min(2 * x + 1, fine.hole.cols - 1)};
                float* mean = coarse.picture.ptr<float>(y) + channels * x;
                for (const int row : rows) {
                    for (const int column : columns) {
                        const float* pixel = fine.picture.ptr<float>(row) + channels * column;
                        for (int c = 0; c < channels; ++c) mean[c] += 0.25F * pixel[c];
                        if (fine.hole.at<std::uint8_t>(row, column) != 0) coarse.hole.at<std::uint8_t>(y, x) = 255;
                    }
                }
            }
        }
    });
    return coarse;
}

std::vector<Level> pyramid(const cv::Mat& picture, const cv::Mat& hole) {
    std::vector<Level> levels(1);
    levels[0].picture = picture;
    levels[0].hole = hole;
    measure(levels[0]);
    while (levels.back().deepest > least_depth_px &&
           std::min(levels.back().hole.rows, levels.back().hole.cols) >= 2 * shortest_side) {
        Level next = halved(levels.back());
        measure(next);
        levels.push_back(std::move(next));
    }
    return levels;
}

// A picture that is 2^halvings times smaller, bilinearly between its pixels.
class Enlarged {
public:
    Enlarged(const cv::Mat& smaller, int halvings) : smaller_(smaller), scale_(1.0 / (1 << halvings)) {}

    void read(int x, int y, float* out) const {
        const Place across = place(x, smaller_.cols), down = place(y, smaller_.rows);
        const int channels = smaller_.channels();
        const float* upper = smaller_.ptr<float>(down.first);
        const float* lower = smaller_.ptr<float>(down.second);
        for (int c = 0; c < channels; ++c) {
            const auto along = [&](const float* row) {
                const float left = row[channels * across.first + c], right = row[channels * across.second + c];
                return left + across.share * (right - left);
            };
            const float top = along(upper);
            out[c] = top + down.share * (along(lower) - top);
        }
    }

private:
    struct Place {
        int first, second;
        float share;
    };
    Place place(int fine, int size) const {
        const double at = std::clamp((fine + 0.5) * scale_ - 0.5, 0.0, size - 1.0);
        const int first = static_cast<int>(at);
        return {first, std::min(first + 1, size - 1), static_cast<float>(at - first)};
    }

    const cv::Mat& smaller_;
    double scale_;
};

// `body(x, y)` for the pixels of a hole.
template <class Body>
void for_hole(const cv::Mat& hole, const Body& body) {
    parallel_for(0, hole.rows, rows_a_task, [&](int first, int last) {
        for (int y = first; y < last; ++y) {
            const std::uint8_t* row = hole.ptr<std::uint8_t>(y);
            for (int x = 0; x < hole.cols; ++x) {
                if (row[x] != 0) body(x, y);
            }
        }
    });
}

// The hole as far as a picture of half the size knows it.
void begin_with(const cv::Mat& coarse, Level& level) {
    const Enlarged enlarged(coarse, 1);
    const int channels = coarse.channels();
    for_hole(level.hole, [&](int x, int y) { enlarged.read(x, y, level.picture.ptr<float>(y) + channels * x); });
}

void search(Level& level, int round_count, std::uint32_t seed) {
    constexpr std::array passes{8, 4, 2, 1};
    for (int round = 0; round < round_count; ++round) {
        level.field->improve(level.picture, passes, anywhere_px, seed + static_cast<std::uint32_t>(10 * round));
        level.field->vote(level.picture);
    }
}

// What was found in a coarser picture, moved by a pixel or two where that fits better.
void follow(Level& level, std::uint32_t seed) {
    constexpr std::array passes{2, 1};
    level.field->improve(level.picture, passes, 2, seed);
    level.field->vote(level.picture);
}

Substitute substitute_of(const Level& level, int halvings) {
    Substitute substitute;
    substitute.halvings = halvings;
    substitute.mismatch = level.field->mismatch(level.picture.channels());
    substitute.smooth = membrane(level.picture, (level.hole == 0) | (substitute.mismatch < most_mismatch));
    return substitute;
}

double smooth_step(double from, double to, double value) {
    const double t = std::clamp((value - from) / (to - from), 0.0, 1.0);
    return t * t * (3 - 2 * t);
}

// Takes the seam away, and fades to the substitute where patches do not fit.
void finish(Level& level, const Substitute& substitute) {
    const int channels = level.picture.channels();
    cv::Mat beside;
    const int seam_halvings = std::max(substitute.halvings, least_seam_halvings);
    const cv::Mat seam = level.field->seam(level.picture, 1 << seam_halvings, beside);
    const cv::Mat missing = cv::countNonZero(beside) > 0 ? membrane(seam, beside) : seam;
    const Enlarged smooth(substitute.smooth, substitute.halvings), lacking(missing, seam_halvings),
        mismatch(substitute.mismatch, substitute.halvings);
    for_hole(level.hole, [&](int x, int y) {
        std::array<float, 4> instead{}, more{};
        float unlike = 0;
        smooth.read(x, y, instead.data());
        lacking.read(x, y, more.data());
        mismatch.read(x, y, &unlike);
        const auto weight = static_cast<float>(smooth_step(good_share * most_mismatch, most_mismatch, unlike));
        float* pixel = level.picture.ptr<float>(y) + channels * x;
        for (std::size_t c = 0; c < static_cast<std::size_t>(channels); ++c) {
            pixel[c] = (1 - weight) * (pixel[c] + more[c]) + weight * instead[c];
        }
    });
}

}  // namespace

void fill_hole(cv::Mat& picture, const cv::Mat& hole, Progress& progress) {
    std::vector<Level> levels = pyramid(picture, hole);
    const PatchField* coarse = nullptr;
    Substitute substitute;
    for (int i = static_cast<int>(levels.size()) - 1; i >= 0; --i) {
        progress.step("background", 1 - (i + 1.0) / static_cast<double>(levels.size()));
        Level& level = levels[static_cast<std::size_t>(i)];
        const bool coarsest = i + 1 == static_cast<int>(levels.size());
        if (coarsest) {
            membrane(level.picture, level.hole == 0).copyTo(level.picture);
        } else {
            begin_with(levels.back().picture, level);
        }
        const bool searched = substitute.smooth.empty() || cv::countNonZero(level.hole) <= searched_pixels;
        level.field = std::make_unique<PatchField>(level.hole, level.depth);
        const auto seed = static_cast<std::uint32_t>(1000 * i);
        // Where too little is known for a patch, finer levels may know enough.
        const bool begun = coarse != nullptr ? level.field->begin(*coarse) : level.field->begin();
        if (begun && searched) {
            search(level, coarse == nullptr ? first_rounds : rounds, seed);
            substitute = substitute_of(level, i);
        } else if (begun) {
            follow(level, seed);
        }
        if (begun) coarse = level.field.get();
        if (!coarsest) levels.pop_back();
    }
    if (coarse != nullptr) finish(levels[0], substitute);
    progress.step("background", 1);
}

}  // namespace puppetwarp
