#include <puppetwarp/image/pnm_writer.h>

#include <bit>
#include <cstring>
#include <string>

// The binary forms P5 and P6 of the Netpbm manual, and Pf / PF of PFM (rows from the bottom up, a negative scale says
// little-endian).

namespace puppetwarp {

namespace {

std::string header(const cv::Mat& pixels, bool colour) {
    const std::string size = std::to_string(pixels.cols) + " " + std::to_string(pixels.rows) + "\n";
    if (pixels.depth() == CV_32F)
        return (colour ? "PF\n" : "Pf\n") + size + (std::endian::native == std::endian::little ? "-1.0\n" : "1.0\n");
    return (colour ? "P6\n" : "P5\n") + size + (pixels.depth() == CV_8U ? "255\n" : "65535\n");
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

void write_pnm(const cv::Mat& pixels, std::string_view format, OutputFile& file) {
    const bool grey = pixels.channels() == 1;
    const int copies = grey && format == "ppm" ? 3 : 1;
    const bool bottom_up = pixels.depth() == CV_32F;
    file.write(header(pixels, !grey || copies == 3));
    std::string row(static_cast<std::size_t>(pixels.cols) * pixels.elemSize() * static_cast<std::size_t>(copies), '\0');
    for (int y = 0; y < pixels.rows; ++y) {
        store_row(pixels, bottom_up ? pixels.rows - 1 - y : y, copies, row);
        file.write(row);
    }
}

}  // namespace puppetwarp
