#include <puppetwarp/diff/side_by_side.h>

#include <puppetwarp/base/picture_text.h>

#include <puppetwarp/diff/display.h>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <string>
#include <vector>

namespace puppetwarp {

namespace {

constexpr int kMargin_px = 12;
constexpr int kSmallest_px = 200;  // longer side of what is shown, at least
constexpr int kVerdictLines = 4;
constexpr std::uint8_t kPaper = 246;
const Rgb kFrame{150, 150, 150};

struct Panel {
    std::string name;
    cv::Mat pixels;  // 8-bit RGB
};

std::vector<Panel> panels_of(const ComparedFiles& files) {
    std::vector<Panel> panels{{"expected", display_rgb(files.expected)}, {"actual", display_rgb(files.actual)}};
    if (!files.heat_map.pixels.empty()) panels.push_back({"difference", files.heat_map.pixels});
    int longest = 0;
    for (const Panel& panel : panels) longest = std::max({longest, panel.pixels.cols, panel.pixels.rows});
    const int factor = (kSmallest_px + longest - 1) / longest;
    if (factor > 1) {
        for (Panel& panel : panels) {
            cv::resize(panel.pixels, panel.pixels, panel.pixels.size() * factor, 0, 0, cv::INTER_NEAREST);
        }
    }
    return panels;
}

void draw_panel(const Panel& panel, const TextStyle& style, int x, int y, cv::Mat& sheet) {
    draw_text(sheet, panel.name, style, x, y);
    const cv::Rect place(x, y + style.line_px(), panel.pixels.cols, panel.pixels.rows);
    sheet(place + cv::Size(2, 2) - cv::Point(1, 1)).setTo(cv::Scalar(kFrame[0], kFrame[1], kFrame[2]));
    panel.pixels.copyTo(sheet(place));
}

}  // namespace

Image side_by_side(const ComparedFiles& files) {
    const std::vector<Panel> panels = panels_of(files);
    int pixels_across = 0, tallest = 0;
    for (const Panel& panel : panels) {
        pixels_across += panel.pixels.cols;
        tallest = std::max(tallest, panel.pixels.rows);
    }
    // Words that can be read also where a large picture is looked at as a whole.
    const TextStyle style{std::clamp(pixels_across / 120.0, 10.0, 60.0), false, {40, 40, 40}};
    const auto column_px = [&](const Panel& panel) {
        return std::max(panel.pixels.cols, text_width(panel.name, style)) + kMargin_px;
    };
    int width = kMargin_px;
    for (const Panel& panel : panels) width += column_px(panel);
    const std::string verdict = files.comparison.same ? "same" : "different: " + files.comparison.reason;
    const std::vector<std::string> lines = wrapped(verdict, style, width - 2 * kMargin_px, kVerdictLines);
    const int height = 3 * kMargin_px + tallest + style.line_px() * (1 + static_cast<int>(lines.size()));

    Image result;
    result.pixels = cv::Mat(height, width, CV_8UC3, cv::Scalar::all(kPaper));
    int x = kMargin_px;
    for (const Panel& panel : panels) {
        draw_panel(panel, style, x, kMargin_px, result.pixels);
        x += column_px(panel);
    }
    int y = 2 * kMargin_px + style.line_px() + tallest;
    for (const std::string& line : lines) {
        draw_text(result.pixels, line, style, kMargin_px, y);
        y += style.line_px();
    }
    return result;
}

}  // namespace puppetwarp
