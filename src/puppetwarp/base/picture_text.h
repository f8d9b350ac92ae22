#pragma once
// Private header: words in a picture.

#include <opencv2/core/mat.hpp>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace puppetwarp {

//! 8-bit red, green, blue.
using Rgb = std::array<std::uint8_t, 3>;

struct TextStyle {
    double height_px = 10;  //!< of a capital letter
    bool bold = false;
    Rgb colour{0, 0, 0};

    //! From one line to the next.
    int line_px() const;
};

//! Width of one line, px. Letters outside of ASCII are drawn as `?`: the font is OpenCV's own, of strokes, so that text
//! has the same pixels wherever the program runs.
int text_width(const std::string& text, const TextStyle& style);

//! Breaks text into lines, after spaces and hyphens where that is possible, else inside words.
//! \param width_px   that no line exceeds, but for one letter in a line.
//! \param max_lines  at least 1; text that needs more ends in `...`.
std::vector<std::string> wrapped(const std::string& text, const TextStyle& style, int width_px, int max_lines);

//! Draws one line over an 8-bit RGB picture, clipped to it. \param x, y  upper left corner of a capital letter.
void draw_text(cv::Mat& picture, const std::string& text, const TextStyle& style, int x, int y);

}  // namespace puppetwarp
