// Warped pictures and backgrounds as rows on demand: the same bytes as in one piece, whatever the pieces.
#include "scenes.h"

#include <puppetwarp/base/errors.h>
#include <puppetwarp/warp/background.h>
#include <puppetwarp/warp/warp_rows.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <optional>

namespace puppetwarp::testing {
namespace {

// All rows, asked for in pieces of random height.
cv::Mat in_pieces(const PictureRows& picture, Random& random) {
    cv::Mat all;
    for (int first = 0; first < picture.height;) {
        const int last = std::min(picture.height, first + 1 + static_cast<int>(random() % 90));
        const cv::Mat piece = picture.rows(first, last);
        EXPECT_EQ(piece.rows, last - first);
        EXPECT_EQ(piece.cols, picture.width);
        EXPECT_EQ(piece.type(), picture.type);
        all.push_back(piece);
        first = last;
    }
    return all;
}

bool is_opaque(const Image& image) {
    if (!image.has_alpha()) return true;
    cv::Mat alpha;
    cv::extractChannel(image.pixels, alpha, image.alpha_channel());
    return cv::countNonZero(alpha != image.full_value()) == 0;
}

struct Scene {
    Image image;
    TriangleMesh rest;
    Eigen::MatrixX2d moved;
    WarpOptions options;
};

// Meshes that stay inside the canvas and such that reach over it, with borders, folds and depths.
Scene random_scene(int type, Random& random) {
    Scene scene{random_image(70, 150, type, random, random() % 2 == 0 ? Alpha::opaque : Alpha::patches), {}, {}, {}};
    const double over = uniform(random, -20, 20);
    scene.rest = grid_mesh(-over, -over, 70 + over, 150 + over, 4, 6, random);
    scene.moved = jittered(scene.rest.V, random() % 3 == 0 ? 0 : random() % 2 == 0 ? 3 : 25, random);
    const int interpolation = static_cast<int>(random() % 4);
    scene.options.interpolation = static_cast<Interpolation>(interpolation);
    scene.options.linear = random() % 3 == 0;
    scene.options.back_faces = random() % 2 == 0 ? BackFaces::hide : BackFaces::show;
    if (random() % 2 == 0) scene.options.canvas = {-5, 7, 83, 170};
    return scene;
}

constexpr int all_types[] = {CV_8UC1,  CV_8UC2,  CV_8UC3,  CV_8UC4,  CV_16UC1, CV_16UC2,
                             CV_16UC3, CV_16UC4, CV_32FC1, CV_32FC2, CV_32FC3, CV_32FC4};

TEST(WarpRows, GiveTheBytesOfTheWholeWarp) {
    Random random(11);
    Progress progress;
    for (const int type : all_types) {
        for (int round = 0; round < 12; ++round) {
            const Scene scene = random_scene(type, random);
            const Image whole = warp(scene.image, scene.rest, scene.moved, scene.options);
            const WarpedRows rows = warp_rows(scene.image, scene.rest, scene.moved, scene.options, progress);
            EXPECT_EQ(rows.picture.width, whole.width());
            EXPECT_EQ(rows.picture.height, whole.height());
            Image drawn{in_pieces(rows.picture, random), {}};
            if (drawn.has_alpha() && !whole.has_alpha()) {
                // Alpha that is full everywhere goes at last, which only the pixels tell.
                EXPECT_FALSE(rows.covered.has_value());
                EXPECT_TRUE(is_opaque(drawn));
                drawn = lay_over({}, drawn, scene.image, {0, 0, drawn.width(), drawn.height()});
            }
            ASSERT_TRUE(same_bytes(drawn.pixels, whole.pixels)) << type << " round " << round;
        }
    }
}

TEST(WarpRows, KnowWhetherTheMeshCoversTheCanvas) {
    Random random(12);
    Progress progress;
    int covered = 0, open = 0;
    for (int round = 0; round < 300; ++round) {
        Scene scene = random_scene(CV_8UC3, random);
        const Image whole = warp(scene.image, scene.rest, scene.moved, scene.options);
        const WarpedRows rows = warp_rows(scene.image, scene.rest, scene.moved, scene.options, progress);
        if (!rows.covered) continue;
        EXPECT_EQ(*rows.covered, is_opaque(whole)) << round;
        ++(*rows.covered ? covered : open);
    }
    EXPECT_GT(covered, 20);
    EXPECT_GT(open, 20);
}

TEST(RowsOver, AreTheRowsOfTheLayeredPicture) {
    Random random(13);
    Progress progress;
    int looked_at = 0;
    for (const int type : all_types) {
        for (int round = 0; round < 20; ++round) {
            const Scene scene = random_scene(type, random);
            // What is cut out has alpha, whether or not the picture has.
            const int channels = CV_MAT_CN(type);
            Image original = scene.image;
            if (channels % 2 == 0 && random() % 2 == 0)
                original = random_image(70, 150, CV_MAKETYPE(CV_MAT_DEPTH(type), channels - 1), random);
            const WarpedRows rows = warp_rows(scene.image, scene.rest, scene.moved, scene.options, progress);
            const Image whole{rows.picture.rows(0, rows.picture.height), {}};
            const Canvas canvas = scene.options.canvas.width > 0 ? scene.options.canvas : Canvas{0, 0, 70, 150};
            for (const char* name : {"transparent", "keep", "#204060", "#20406080"}) {
                const Background background = background_from_name(name);
                const WarpedRows layered = rows_over(background, rows, original, canvas, scene.options.linear);
                const Image expected = lay_over(background, whole, original, canvas, scene.options.linear);
                ASSERT_TRUE(same_bytes(in_pieces(layered.picture, random), expected.pixels)) << name << " " << type;
                if (!layered.covered) continue;
                ASSERT_EQ(*layered.covered, is_opaque(expected)) << name << " " << type;
                ++looked_at;
            }
        }
    }
    EXPECT_GT(looked_at, 50);
}

// Large pictures are looked at a part at a time, down to the first row that is open, and never held as a whole.
TEST(RowsOver, LookForOpenPixelsPieceByPiece) {
    constexpr int height = 2000;
    for (const int open_row : {0, 700, height - 1, height}) {
        cv::Mat pixels(height, 8, CV_8UC4, cv::Scalar(10, 20, 30, 255));
        if (open_row < height) pixels.at<cv::Vec4b>(open_row, 5)[3] = 254;
        int highest = 0, lowest_row = 0;
        const PictureRows picture{8, height, CV_8UC4, {}, [&](int first, int last) {
                                      highest = std::max(highest, last - first);
                                      lowest_row = std::max(lowest_row, last);
                                      return pixels.rowRange(first, last);
                                  }};
        const Image original{cv::Mat(height, 8, CV_8UC3, cv::Scalar(0)), {}};
        const WarpedRows layered = rows_over({}, {picture, std::nullopt}, original, {0, 0, 8, height});
        EXPECT_EQ(layered.covered == false, open_row < height);
        EXPECT_EQ(CV_MAT_CN(layered.picture.type), open_row == height ? 3 : 4);
        EXPECT_LT(highest, height / 4);
        EXPECT_LT(lowest_row, open_row + height / 4);
    }
}

TEST(WarpRows, SayWhatIsWrongAtOnce) {
    Random random(14);
    Progress progress;
    const Image image = random_image(10, 10, CV_8UC3, random);
    const TriangleMesh rest = grid_mesh(0, 0, 10, 10, 2, 2, random);
    Eigen::MatrixX2d moved = rest.V;
    moved(3, 1) = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THROW(warp_rows(image, rest, moved, {}, progress), InvalidInput);
}

TEST(WarpRows, OutliveWhatTheyWereMadeFrom) {
    Random random(15);
    Progress progress;
    std::optional<WarpedRows> rows;
    cv::Mat expected;
    {
        const Scene scene = random_scene(CV_8UC4, random);
        expected = warp(scene.image, scene.rest, scene.moved, scene.options).pixels;
        rows = warp_rows(scene.image, scene.rest, scene.moved, scene.options, progress);
    }
    EXPECT_TRUE(same_bytes(in_pieces(rows->picture, random), expected));
}

}  // namespace
}  // namespace puppetwarp::testing
