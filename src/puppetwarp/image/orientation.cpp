#include <puppetwarp/image/orientation.h>

#include <opencv2/core.hpp>

namespace puppetwarp {

namespace {

enum Flip { upside_down = 0, left_right = 1, both = -1 };

cv::Mat flipped(cv::Mat pixels, Flip flip) {
    cv::flip(pixels, pixels, flip);
    return pixels;
}

cv::Mat transposed(const cv::Mat& pixels) {
    cv::Mat turned;
    cv::transpose(pixels, turned);
    return turned;
}

}  // namespace

cv::Mat upright(cv::Mat stored, int orientation) {
    switch (orientation) {
        case 2: return flipped(std::move(stored), left_right);
        case 3: return flipped(std::move(stored), both);
        case 4: return flipped(std::move(stored), upside_down);
        case 5: return transposed(stored);
        case 6: return flipped(transposed(stored), left_right);  // stored quarter turn clockwise
        case 7: return flipped(transposed(stored), both);
        case 8: return flipped(transposed(stored), upside_down);
        default: return stored;
    }
}

}  // namespace puppetwarp
