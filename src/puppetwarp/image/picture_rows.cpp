#include <puppetwarp/image/picture_rows.h>

#include <opencv2/core.hpp>

namespace puppetwarp {

PictureRows rows_of(const Image& image) {
    const cv::Mat& pixels = image.pixels;
    return {image.width(), image.height(), pixels.type(), image.metadata,
            [pixels](int first, int last) { return pixels.rowRange(first, last); }};
}

Image whole_picture(const PictureRows& picture) {
    return {picture.rows(0, picture.height), picture.metadata};
}

}  // namespace puppetwarp
