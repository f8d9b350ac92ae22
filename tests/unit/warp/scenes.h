#pragma once

#include <puppetwarp/base/image.h>
#include <puppetwarp/mesh/triangle_mesh.h>
#include <puppetwarp/warp/warp.h>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include <cstdint>
#include <cstring>
#include <random>
#include <string>
#include <vector>

// Pictures, meshes and deformations that the tests of the warp draw at random.
namespace puppetwarp::testing {

using Random = std::mt19937_64;

inline double uniform(Random& random, double low, double high) {
    return low + (high - low) * static_cast<double>(random() >> 11) * 0x1p-53;
}

constexpr Interpolation all_interpolations[] = {Interpolation::nearest, Interpolation::bilinear, Interpolation::bicubic,
                                                Interpolation::lanczos3};
inline const std::vector<int> all_types{CV_8UC1,  CV_8UC2,  CV_8UC3,  CV_8UC4,  CV_16UC1, CV_16UC2,
                                        CV_16UC3, CV_16UC4, CV_32FC1, CV_32FC2, CV_32FC3, CV_32FC4};

//! For test suites over formats.
inline std::string format_name(const ::testing::TestParamInfo<int>& format) {
    const int depth = CV_MAT_DEPTH(format.param);
    return (depth == CV_8U ? "U8C" : depth == CV_16U ? "U16C" : "F32C") + std::to_string(CV_MAT_CN(format.param));
}

enum class Alpha { noise, opaque, patches };

//! Noise in every channel; alpha as asked.
inline Image random_image(int width, int height, int type, Random& random, Alpha alpha = Alpha::noise) {
    Image image{cv::Mat(height, width, type), {}};
    const int channels = image.pixels.channels();
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            const double patch = (x / 5 + y / 4) % 3 == 0 ? 0 : (x / 5 + y / 4) % 3 == 1 ? 1 : uniform(random, 0, 1);
            for (int c = 0; c < channels; ++c) {
                double value = uniform(random, 0, 1);
                if (image.has_alpha() && c == channels - 1) {
                    value = alpha == Alpha::opaque ? 1 : alpha == Alpha::patches ? patch : value;
                }
                const int i = x * channels + c;
                switch (image.pixels.depth()) {
                    case CV_8U:
                        image.pixels.ptr<std::uint8_t>(y)[i] = cv::saturate_cast<std::uint8_t>(value * 255);
                        break;
                    case CV_16U:
                        image.pixels.ptr<std::uint16_t>(y)[i] = cv::saturate_cast<std::uint16_t>(value * 65535);
                        break;
                    default: image.pixels.ptr<float>(y)[i] = static_cast<float>(value);
                }
            }
        }
    }
    return image;
}

//! A grid of 2 x n x m triangles over a rectangle, diagonals at random.
inline TriangleMesh grid_mesh(double left, double top, double right, double bottom, int n, int m, Random& random) {
    TriangleMesh mesh;
    mesh.V.resize((n + 1) * (m + 1), 2);
    mesh.F.resize(2 * n * m, 3);
    for (int j = 0; j <= m; ++j) {
        for (int i = 0; i <= n; ++i) {
            const int k = j * (n + 1) + i;
            mesh.V.row(k) << left + (right - left) * i / n, top + (bottom - top) * j / m;
            if (i == n || j == m) continue;
            const int a = k, b = k + 1, c = k + n + 2, d = k + n + 1, f = 2 * (j * n + i);
            if (random() % 2 == 0) {
                mesh.F.row(f) << a, b, c;
                mesh.F.row(f + 1) << a, c, d;
            } else {
                mesh.F.row(f) << a, b, d;
                mesh.F.row(f + 1) << b, c, d;
            }
        }
    }
    return mesh;
}

//! Every vertex moved by at most `most` along each axis.
inline Eigen::MatrixX2d jittered(const Eigen::MatrixX2d& V, double most, Random& random) {
    Eigen::MatrixX2d moved = V;
    for (Eigen::Index i = 0; i < V.rows(); ++i) {
        moved(i, 0) += uniform(random, -most, most);
        moved(i, 1) += uniform(random, -most, most);
    }
    return moved;
}

//! A picture's channel as a number in its own scale.
inline double value_at(const Image& image, int x, int y, int c) {
    const int i = x * image.pixels.channels() + c;
    switch (image.pixels.depth()) {
        case CV_8U: return image.pixels.ptr<std::uint8_t>(y)[i];
        case CV_16U: return image.pixels.ptr<std::uint16_t>(y)[i];
        default: return static_cast<double>(image.pixels.ptr<float>(y)[i]);
    }
}

inline bool same_bytes(const cv::Mat& a, const cv::Mat& b) {
    if (a.size() != b.size() || a.type() != b.type()) return false;
    for (int y = 0; y < a.rows; ++y) {
        if (std::memcmp(a.ptr(y), b.ptr(y), a.elemSize() * static_cast<std::size_t>(a.cols)) != 0) return false;
    }
    return true;
}

}  // namespace puppetwarp::testing
