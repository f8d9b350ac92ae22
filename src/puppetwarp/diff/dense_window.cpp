#include <puppetwarp/diff/dense_window.h>

#include <algorithm>
#include <vector>

namespace puppetwarp {

DenseWindow densest_window(const cv::Mat& marks, std::uint8_t mark, int side_px) {
    const int width = std::min(side_px, marks.cols), height = std::min(side_px, marks.rows);
    std::vector<int> columns(static_cast<std::size_t>(marks.cols));  // marked pixels of each, as high as the window
    const auto count = [&](int y, int sign) {
        const std::uint8_t* row = marks.ptr(y);
        for (int x = 0; x < marks.cols; ++x) columns[static_cast<std::size_t>(x)] += (row[x] & mark) != 0 ? sign : 0;
    };
    DenseWindow densest;
    for (int y = 0; y < marks.rows; ++y) {
        count(y, 1);
        if (y >= height) count(y - height, -1);
        if (y + 1 < height) continue;
        int pixels = 0;
        for (int x = 0; x < marks.cols; ++x) {
            pixels += columns[static_cast<std::size_t>(x)];
            if (x >= width) pixels -= columns[static_cast<std::size_t>(x - width)];
            if (x + 1 >= width && pixels > densest.pixels) densest = {pixels, x + 1 - width, y + 1 - height};
        }
    }
    return densest;
}

}  // namespace puppetwarp
