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

// \param heard  hears what share is done, and may throw.
template <class Heard>
void search(Level& level, int round_count, std::uint32_t seed, const Heard& heard) {
    constexpr std::array passes{8, 4, 2, 1};
    for (int round = 0; round < round_count; ++round) {
        heard(static_cast<double>(round) / round_count);
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

void find_substitute(const Level& level, int halvings, HoleFilling& filling) {
    filling.halvings = halvings;
    filling.mismatch = level.field->mismatch(level.picture.channels());
    filling.smooth = membrane(level.picture, (level.hole == 0) | (filling.mismatch < most_mismatch));
}

// What all patches together lack beside the hole, spread over it.
void find_seam(const Level& level, HoleFilling& filling) {
    filling.seam_halvings = std::max(filling.halvings, least_seam_halvings);
    cv::Mat beside;
    const cv::Mat seam = level.field->seam(level.picture, 1 << filling.seam_halvings, beside);
    filling.missing = cv::countNonZero(beside) > 0 ? membrane(seam, beside) : seam;
    filling.offset = level.field->offsets();
    filling.weight = level.field->votes(level.picture.channels());
}

double smooth_step(double from, double to, double value) {
    const double t = std::clamp((value - from) / (to - from), 0.0, 1.0);
    return t * t * (3 - 2 * t);
}

}  // namespace

FillingFinish::FillingFinish(const HoleFilling& filling, int halvings)
    : smooth_(filling.smooth, filling.halvings + halvings),
      mismatch_(filling.mismatch, filling.halvings + halvings),
      missing_(filling.missing, filling.seam_halvings + halvings) {}

void FillingFinish::apply(int x, int y, int channels, float* pixel) const {
    std::array<float, 4> instead{}, more{};
    float unlike = 0;
    smooth_.read(x, y, instead.data());
    missing_.read(x, y, more.data());
    mismatch_.read(x, y, &unlike);
    const auto weight = static_cast<float>(smooth_step(good_share * most_mismatch, most_mismatch, unlike));
    for (std::size_t c = 0; c < static_cast<std::size_t>(channels); ++c) {
        pixel[c] = (1 - weight) * (pixel[c] + more[c]) + weight * instead[c];
    }
}

HoleFilling fill_hole(cv::Mat& picture, const cv::Mat& hole, Progress& progress) {
    std::vector<Level> levels = pyramid(picture, hole);
    const PatchField* coarse = nullptr;
    HoleFilling filling;
    const auto count = static_cast<double>(levels.size());
    for (int i = static_cast<int>(levels.size()) - 1; i >= 0; --i) {
        const auto heard = [&](double share) { progress.step("background", (count - 1 - i + share) / count); };
        heard(0);
        Level& level = levels[static_cast<std::size_t>(i)];
        const bool coarsest = i + 1 == static_cast<int>(levels.size());
        if (coarsest) {
            membrane(level.picture, level.hole == 0).copyTo(level.picture);
        } else {
            begin_with(levels.back().picture, level);
        }
        const bool searched = filling.smooth.empty() || cv::countNonZero(level.hole) <= searched_pixels;
        level.field = std::make_unique<PatchField>(level.hole, level.depth);
        const auto seed = static_cast<std::uint32_t>(1000 * i);
        // Where too little is known for a patch, finer levels may know enough.
        const bool begun = coarse != nullptr ? level.field->begin(*coarse) : level.field->begin();
        if (begun && searched) {
            search(level, coarse == nullptr ? first_rounds : rounds, seed, heard);
            find_substitute(level, i, filling);
        } else if (begun) {
            follow(level, seed);
        }
        if (begun) coarse = level.field.get();
        if (!coarsest) levels.pop_back();
    }
    if (coarse == nullptr) return filling;
    find_seam(levels[0], filling);
    const FillingFinish finish(filling, 0);
    for_hole(hole, [&](int x, int y) {
        finish.apply(x, y, picture.channels(), picture.ptr<float>(y) + picture.channels() * x);
    });
    return filling;
}

}  // namespace puppetwarp
