#include <puppetwarp/image/pnm_writer.h>

#include <opencv2/core.hpp>

#include <algorithm>
#include <bit>
#include <cstring>
#include <string>

// The binary forms P5 and P6 of the Netpbm manual, and Pf / PF of PFM (rows from the bottom up, a negative scale says
// little-endian).

namespace puppetwarp {

namespace {

constexpr int rows_at_a_time = 256;

std::string header(const PictureRows& picture, bool colour) {
    const std::string size = std::to_string(picture.width) + " " + std::to_string(picture.height) + "\n";
    const int depth = CV_MAT_DEPTH(picture.type);
    if (depth == CV_32F)
        return (colour ? "PF\n" : "Pf\n") + size + (std::endian::native == std::endian::little ? "-1.0\n" : "1.0\n");
    return (colour ? "P6\n" : "P5\n") + size + (depth == CV_8U ? "255\n" : "65535\n");
}

// One row as in the file: values of several bytes begin with the highest, floats stay as they are in memory.
void store_row(const cv::Mat& pixels, int y, int copies, std::string& bytes) {
    const std::size_t values = static_cast<std::size_t>(pixels.cols) * static_cast<std::size_t>(pixels.channels());
    const std::size_t width = pixels.elemSize1();
    const std::uint8_t* from = pixels.ptr(y);
    char* to = bytes.data();
    for (std::size_t i = 0; i < values; ++i, from += width) {
        for (int copy = 0; copy < copies; ++copy, to += width) {
            std::memcpy(to, from, width);
            if (pixels.depth() == CV_16U && std::endian::native == std::endian::little) std::swap(to[0], to[1]);
        }
    }
}

}  // namespace

void write_pnm(const PictureRows& picture, std::string_view format, OutputFile& file) {
    const bool grey = CV_MAT_CN(picture.type) == 1;
    const int copies = grey && format == "ppm" ? 3 : 1;
    file.write(header(picture, !grey || copies == 3));
    std::string row(
        static_cast<std::size_t>(picture.width) * CV_ELEM_SIZE(picture.type) * static_cast<std::size_t>(copies), '\0');
    const auto write_rows = [&](const cv::Mat& rows, bool bottom_up) {
        for (int y = 0; y < rows.rows; ++y) {
            store_row(rows, bottom_up ? rows.rows - 1 - y : y, copies, row);
            file.write(row);
        }
    };
    if (CV_MAT_DEPTH(picture.type) == CV_32F) {
        for (int last = picture.height; last > 0; last -= rows_at_a_time)
            write_rows(picture.rows(std::max(0, last - rows_at_a_time), last), true);
        return;
    }
    for (int first = 0; first < picture.height; first += rows_at_a_time)
        write_rows(picture.rows(first, std::min(picture.height, first + rows_at_a_time)), false);
}

}  // namespace puppetwarp
