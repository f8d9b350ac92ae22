#include <puppetwarp/diff/display.h>

#include <puppetwarp/base/threads.h>
#include <puppetwarp/diff/measure.h>
#include <puppetwarp/image/convert.h>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>

namespace puppetwarp {

namespace {

constexpr int kChequer_px = 8;
constexpr int kDarkChequer = 192, kLightChequer = 224;

int chequer(int x, int y) {
    return (x / kChequer_px + y / kChequer_px) % 2 == 0 ? kLightChequer : kDarkChequer;
}

void draw_row(const std::uint8_t* pixel, int channels, int y, int width, cv::Vec3b* to) {
    const bool grey = channels < 3, alpha = channels % 2 == 0;
    for (int x = 0; x < width; ++x, pixel += channels) {
        const int share = alpha ? pixel[channels - 1] : 255;
        for (int c = 0; c < 3; ++c) {
            const int colour = pixel[grey ? 0 : c];
            to[x][c] = static_cast<std::uint8_t>((colour * share + chequer(x, y) * (255 - share) + 127) / 255);
        }
    }
}

}  // namespace

cv::Mat display_rgb(const Image& image) {
    const cv::Mat bytes = to_depth(image.pixels, CV_8U);
    cv::Mat shown(bytes.size(), CV_8UC3);
    parallel_for(0, bytes.rows, kBandRows, [&](int first, int last) {
        for (int y = first; y < last; ++y) {
            draw_row(bytes.ptr(y), bytes.channels(), y, bytes.cols, shown.ptr<cv::Vec3b>(y));
        }
    });
    return shown;
}

PagePicture page_picture(const Image& image, int longest_px) {
    PagePicture picture;
    picture.pixels = to_depth(image.pixels, CV_8U);
    const int longest = std::max(image.width(), image.height());
    picture.shrunk = (longest + longest_px - 1) / longest_px;
    if (picture.shrunk > 1) {
        const cv::Size size((image.width() + picture.shrunk - 1) / picture.shrunk,
                            (image.height() + picture.shrunk - 1) / picture.shrunk);
        cv::Mat smaller;
        cv::resize(picture.pixels, smaller, size, 0, 0, cv::INTER_AREA);
        picture.pixels = smaller;
    }
    return picture;
}

}  // namespace puppetwarp
