#include <puppetwarp/base/picture_text.h>

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>

namespace puppetwarp {

namespace {

constexpr int oversampling = 4;  // strokes are drawn this much larger, then averaged: even, whatever their direction
constexpr double font_capital_px = 21;  // height of OpenCV's capital letters at scale 1

struct Strokes {
    int face;
    double scale;
    int thickness;
};

Strokes strokes_of(const TextStyle& style) {
    const double size = oversampling * style.height_px;
    return {style.bold ? cv::FONT_HERSHEY_DUPLEX : cv::FONT_HERSHEY_SIMPLEX, size / font_capital_px,
            std::max(1, static_cast<int>(std::lround(size * (style.bold ? 0.16 : 0.12))))};
}

// One `?` for each letter that the font does not have.
std::string in_font(const std::string& text) {
    std::string result;
    for (const char c : text) {
        const auto byte = static_cast<unsigned char>(c);
        if ((byte & 0xC0U) == 0x80U) continue;  // the rest of a letter of several bytes
        result += byte >= ' ' && byte < 127 ? c : '?';
    }
    return result;
}

// Where a line that starts at `start` and is no longer than `fitting` letters ends.
std::size_t line_end(const std::string& text, std::size_t start, std::size_t fitting) {
    if (start + fitting >= text.size()) return text.size();
    for (std::size_t end = start + fitting; end > start + 1; --end) {
        if (text[end] == ' ' || text[end - 1] == ' ' || text[end - 1] == '-') return end;
    }
    return start + fitting;
}

std::size_t letters_that_fit(const std::string& text, std::size_t start, const TextStyle& style, int width_px) {
    std::size_t count = 1;
    while (start + count < text.size() && text_width(text.substr(start, count + 1), style) <= width_px) ++count;
    return count;
}

}  // namespace

int TextStyle::line_px() const {
    return static_cast<int>(std::lround(1.75 * height_px));
}

int text_width(const std::string& text, const TextStyle& style) {
    const Strokes strokes = strokes_of(style);
    int below = 0;
    const cv::Size size = cv::getTextSize(in_font(text), strokes.face, strokes.scale, strokes.thickness, &below);
    return (size.width + oversampling - 1) / oversampling;
}

std::vector<std::string> wrapped(const std::string& text, const TextStyle& style, int width_px, int max_lines) {
    const std::string letters = in_font(text);
    std::vector<std::string> lines;
    for (std::size_t start = 0; start < letters.size();) {
        const std::size_t end = line_end(letters, start, letters_that_fit(letters, start, style, width_px));
        lines.push_back(letters.substr(start, end - start));
        while (!lines.back().empty() && lines.back().back() == ' ') lines.back().pop_back();
        start = end;
        while (start < letters.size() && letters[start] == ' ') ++start;
        if (start < letters.size() && static_cast<int>(lines.size()) == max_lines) {
            std::string& last = lines.back();
            while (!last.empty() && text_width(last + "...", style) > width_px) last.pop_back();
            last += "...";
            break;
        }
    }
    return lines;
}

void draw_text(cv::Mat& picture, const std::string& text, const TextStyle& style, int x, int y) {
    const Strokes strokes = strokes_of(style);
    const std::string letters = in_font(text);
    const int capital = static_cast<int>(std::ceil(style.height_px));
    const int margin = capital;  // for what reaches above, below and to the sides of capitals
    cv::Mat large = cv::Mat::zeros(oversampling * (capital + 2 * margin),
                                   oversampling * (text_width(letters, style) + 2 * margin), CV_8UC1);
    cv::putText(large, letters, {oversampling * margin, oversampling * (margin + capital)}, strokes.face, strokes.scale,
                cv::Scalar(255), strokes.thickness, cv::LINE_AA);
    cv::Mat coverage;
    cv::resize(large, coverage, large.size() / oversampling, 0, 0, cv::INTER_AREA);
    const cv::Rect placed(x - margin, y - margin, coverage.cols, coverage.rows);
    const cv::Rect visible = placed & cv::Rect(0, 0, picture.cols, picture.rows);
    for (int row = visible.y; row < visible.y + visible.height; ++row) {
        const std::uint8_t* over = coverage.ptr<std::uint8_t>(row - placed.y);
        auto* pixel = picture.ptr<cv::Vec3b>(row);
        for (int column = visible.x; column < visible.x + visible.width; ++column) {
            const int share = over[column - placed.x];
            for (int c = 0; c < 3; ++c) {
                const int under = pixel[column][c];
                const int ink = style.colour[static_cast<std::size_t>(c)];
                pixel[column][c] = static_cast<std::uint8_t>((ink * share + under * (255 - share) + 127) / 255);
            }
        }
    }
}

}  // namespace puppetwarp
