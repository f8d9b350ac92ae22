#include <puppetwarp/base/picture_text.h>
#include <puppetwarp/project/sheet_layout.h>

#include <opencv2/core.hpp>

#include <gtest/gtest.h>

#include <vector>

namespace puppetwarp {
namespace {

SheetContents contents_of(int cells, int columns, int picture_width) {
    SheetContents contents;
    contents.cells = cells;
    contents.columns = columns;
    contents.picture_width = picture_width;
    contents.picture_height = 300;
    contents.text_height = 50;
    contents.header_height = 20;
    contents.footer_height = 90;
    return contents;
}

// Opposite corners of a box.
Eigen::MatrixX2d box(double left, double top, double right, double bottom) {
    Eigen::MatrixX2d V(2, 2);
    V << left, top, right, bottom;
    return V;
}

TEST(CommonView, HoldsEveryMethodWithAMargin) {
    // The union is 0..100 by -20..60: 128.06 in size, 3.84 of margin.
    const std::vector<Eigen::MatrixX2d> moved{box(5, -20, 90, 60), box(0, 0, 100, 60), box(20, 20, 30, 30)};
    const Canvas view = common_view(box(10, 0, 70, 50), moved);
    EXPECT_EQ(view.x, -4);
    EXPECT_EQ(view.y, -24);
    EXPECT_EQ(view.x + view.width, 104);
    EXPECT_EQ(view.y + view.height, 64);
    for (const Eigen::MatrixX2d& each : moved) EXPECT_FALSE(runs_out_of(view, each));
}

TEST(CommonView, ShowsTheSubjectAtRestWhenNothingMoves) {
    const Canvas view = common_view(box(0, 0, 300, 400), {});  // 500 in size, 15 of margin
    EXPECT_EQ(view.x, -15);
    EXPECT_EQ(view.y, -15);
    EXPECT_EQ(view.width, 330);
    EXPECT_EQ(view.height, 430);
}

TEST(CommonView, CutsOffWhatRunsAway) {
    // Most stay in 0..30 by 0..40, 50 in size; one may reach 12.5 farther. 1.5 of margin.
    const std::vector<Eigen::MatrixX2d> moved{box(0, 0, 30, 40), box(0, 0, 1e6, 40), box(0, 0, 29, 39)};
    const Canvas view = common_view(box(1, 1, 28, 38), moved);
    EXPECT_EQ(view.x, -2);
    EXPECT_EQ(view.x + view.width, 32);
    EXPECT_EQ(view.y + view.height, 42);
    EXPECT_FALSE(runs_out_of(view, moved[0]));
    EXPECT_TRUE(runs_out_of(view, moved[1]));
}

TEST(CommonView, FollowsWhatMostMethodsDoFarAway) {
    const std::vector<Eigen::MatrixX2d> moved(3, box(5000, 5000, 5100, 5100));
    const Canvas view = common_view(box(0, 0, 100, 100), moved);
    for (const Eigen::MatrixX2d& each : moved) EXPECT_FALSE(runs_out_of(view, each));
    const Canvas whole = common_view(box(0, 0, 100, 100), {box(-1e300, -1e300, 1e300, 1e300)});
    EXPECT_GT(whole.width, 0);
    EXPECT_GT(whole.height, 0);
}

TEST(SheetLayout, CellsFollowEachOtherInRows) {
    const SheetLayout layout(contents_of(7, 3, 400));
    EXPECT_EQ(layout.columns(), 3);
    EXPECT_EQ(layout.rows(), 3);
    EXPECT_EQ(layout.picture(1).x - layout.picture(0).x, 400 + SheetLayout::gap_px);
    EXPECT_EQ(layout.picture(0).y, layout.picture(2).y);
    EXPECT_EQ(layout.picture(3).x, layout.picture(0).x);
    EXPECT_GT(layout.picture(3).y, layout.text(0).y + layout.text(0).height);
    EXPECT_EQ(layout.picture(6).size(), cv::Size(400, 300));
}

TEST(SheetLayout, NothingOverlapsAndNothingStandsOutside) {
    for (const int cells : {1, 2, 5, 16, 18}) {
        for (const int columns : {0, 1, 4, 64}) {
            for (const int width : {20, 216, 500}) {
                const SheetLayout layout(contents_of(cells, columns, width));
                std::vector<cv::Rect> places{layout.header(), layout.footer()};
                for (int cell = 0; cell < cells; ++cell) {
                    places.push_back(layout.picture(cell));
                    places.push_back(layout.text(cell));
                }
                const cv::Rect sheet({0, 0}, layout.size());
                for (std::size_t i = 0; i < places.size(); ++i) {
                    EXPECT_EQ(places[i] & sheet, places[i]) << cells << ' ' << columns << ' ' << width;
                    for (std::size_t j = 0; j < i; ++j) EXPECT_EQ((places[i] & places[j]).area(), 0) << i << ' ' << j;
                }
            }
        }
    }
}

TEST(SheetLayout, NarrowPicturesStandInTheMiddleOfColumnsWithRoomForWords) {
    const SheetLayout layout(contents_of(4, 2, 100));
    EXPECT_EQ(layout.text(1).width, SheetLayout::narrowest_column_px);
    EXPECT_EQ(2 * layout.picture(1).x + layout.picture(1).width, 2 * layout.text(1).x + layout.text(1).width);
}

TEST(SheetLayout, ChosenColumnsMakeAPleasantSheet) {
    for (const int cells : {6, 9, 12, 16, 18}) {
        for (const int width : {220, 300, 500}) {
            const SheetLayout layout(contents_of(cells, 0, width));
            const double ratio = static_cast<double>(layout.size().width) / layout.size().height;
            EXPECT_GT(ratio, 0.7) << cells << ' ' << width;
            EXPECT_LT(ratio, 3.0) << cells << ' ' << width;
            EXPECT_LE(layout.columns() * layout.rows() - cells, cells / 4) << width;
        }
    }
    EXPECT_EQ(SheetLayout(contents_of(2, 64, 300)).columns(), 2);  // never more than there are cells
}

TEST(SheetText, WrapsAtSpacesAndHyphensAndInsideLongWords) {
    const TextStyle style;
    const int width = text_width("laplacian-", style);
    EXPECT_EQ(wrapped("laplacian-similarity", style, width, 9), (std::vector<std::string>{"laplacian-", "similarity"}));
    EXPECT_EQ(wrapped("one two", style, text_width("one t", style), 9), (std::vector<std::string>{"one", "two"}));
    for (const std::string& text : {std::string(200, 'm'), std::string("a handle with 'many many' words (do this)")}) {
        std::string letters, all;
        for (const std::string& line : wrapped(text, style, width, 99)) {
            EXPECT_LE(text_width(line, style), width) << line;
            letters += line;
        }
        for (const char c : text) all += c == ' ' ? "" : std::string(1, c);
        std::erase(letters, ' ');
        EXPECT_EQ(letters, all);
    }
    EXPECT_TRUE(wrapped("", style, width, 3).empty());
}

TEST(SheetText, WhatIsTooLongEndsInDots) {
    const TextStyle style;
    const std::vector<std::string> lines = wrapped("one two three four five six seven", style, 60, 2);
    ASSERT_EQ(lines.size(), 2U);
    EXPECT_EQ(lines[1].substr(lines[1].size() - 3), "...");
    EXPECT_LE(text_width(lines[1], style), 60);
}

TEST(SheetText, ALetterOutsideTheFontIsOneMark) {
    const TextStyle style;
    EXPECT_EQ(wrapped("caf\xC3\xA9 \xE2\x82\xAC", style, 500, 1), (std::vector<std::string>{"caf? ?"}));
}

TEST(SheetText, DrawsInsideItsSizeInItsColourAndNowhereElse) {
    cv::Mat picture(60, 300, CV_8UC3, cv::Scalar::all(255));
    const TextStyle style{12, false, {200, 0, 30}};
    draw_text(picture, "HELLO", style, 40, 20);
    const cv::Rect place(39, 19, text_width("HELLO", style) + 2, 15);
    double darkest = 255;
    cv::minMaxLoc(picture(place).reshape(1), &darkest, nullptr);
    EXPECT_EQ(darkest, 0);  // green of a stroke's middle
    picture(place).setTo(cv::Scalar::all(255));
    EXPECT_EQ(cv::norm(picture, cv::Mat(60, 300, CV_8UC3, cv::Scalar::all(255)), cv::NORM_INF), 0);
}

TEST(SheetText, IsClippedToThePicture) {
    cv::Mat picture(20, 30, CV_8UC3, cv::Scalar::all(255));
    draw_text(picture, "far too long for this", {12, true, {0, 0, 0}}, -20, -4);
    draw_text(picture, "nowhere", {12, true, {0, 0, 0}}, 500, 500);
    EXPECT_EQ(picture.size(), cv::Size(30, 20));
}

}  // namespace
}  // namespace puppetwarp
