#include <puppetwarp/diff/mask.h>

#include <puppetwarp/diff/row_reader.h>

namespace puppetwarp {

cv::Mat comparison_mask(const Image& picture) {
    RowReader<double> rows(picture.pixels, AlphaRule::premultiplied);
    const int channels = rows.channels();
    cv::Mat mask(picture.pixels.size(), CV_8U);
    for (int y = 0; y < mask.rows; ++y) {
        const double* pixel = rows.row(y);
        for (int x = 0; x < mask.cols; ++x, pixel += channels) {
            const double luma = channels < 3 ? pixel[0] : 0.299 * pixel[0] + 0.587 * pixel[1] + 0.114 * pixel[2];
            mask.at<std::uint8_t>(y, x) = luma >= 0.5 ? 1 : 0;
        }
    }
    return mask;
}

}  // namespace puppetwarp
