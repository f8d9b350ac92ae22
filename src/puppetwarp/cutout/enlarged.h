#pragma once
// Private header.

#include <opencv2/core/mat.hpp>

#include <algorithm>

namespace puppetwarp {

//! A picture of floats that is 2^halvings times smaller, bilinearly between its pixels.
class Enlarged {
public:
    Enlarged(const cv::Mat& smaller, int halvings) : smaller_(smaller), scale_(1.0 / (1 << halvings)) {}

    void read(int x, int y, float* out) const {
        const Place across = place(x, smaller_.cols), down = place(y, smaller_.rows);
        const int channels = smaller_.channels();
        const float* upper = smaller_.ptr<float>(down.first);
        const float* lower = smaller_.ptr<float>(down.second);
        for (int c = 0; c < channels; ++c) {
            const auto along = [&](const float* row) {
                const float left = row[channels * across.first + c], right = row[channels * across.second + c];
                return left + across.share * (right - left);
            };
            const float top = along(upper);
            out[c] = top + down.share * (along(lower) - top);
        }
    }

private:
    struct Place {
        int first, second;
        float share;
    };
    Place place(int fine, int size) const {
        const double at = std::clamp((fine + 0.5) * scale_ - 0.5, 0.0, size - 1.0);
        const int first = static_cast<int>(at);
        return {first, std::min(first + 1, size - 1), static_cast<float>(at - first)};
    }

    const cv::Mat& smaller_;
    double scale_;
};

}  // namespace puppetwarp
