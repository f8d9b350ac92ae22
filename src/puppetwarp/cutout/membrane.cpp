#include <puppetwarp/cutout/membrane.h>

#include <puppetwarp/base/threads.h>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <vector>

namespace puppetwarp {

namespace {

constexpr int rows_a_task = 32;

// Values times how far they are known, and how far that is: from 0, nothing, to 1.
struct Layer {
    cv::Mat values;
    cv::Mat weight;
};

void multiply_rows(cv::Mat& values, const cv::Mat& factor) {
    const int channels = values.channels();
    parallel_for(0, values.rows, rows_a_task, [&](int first, int last) {
        for (int y = first; y < last; ++y) {
            float* value = values.ptr<float>(y);
            const float* f = factor.ptr<float>(y);
            for (int x = 0; x < values.cols; ++x) {
                for (int c = 0; c < channels; ++c) *value++ *= f[x];
            }
        }
    });
}

// What half of the smaller pixels know, the larger one knows for sure.
Layer pulled(const Layer& fine) {
    const cv::Size size((fine.weight.cols + 1) / 2, (fine.weight.rows + 1) / 2);
    Layer coarse;
    cv::pyrDown(fine.values, coarse.values, size);
    cv::pyrDown(fine.weight, coarse.weight, size);
    cv::Mat gain(size, CV_32F);
    for (int y = 0; y < size.height; ++y) {
        float* weight = coarse.weight.ptr<float>(y);
        float* g = gain.ptr<float>(y);
        for (int x = 0; x < size.width; ++x) {
            const float sure = std::min(1.0F, 2 * weight[x]);
            g[x] = weight[x] > 0 ? sure / weight[x] : 0.0F;
            weight[x] = sure;
        }
    }
    multiply_rows(coarse.values, gain);
    return coarse;
}

// What the finer layer lacks comes from the coarser one, which knows everything.
void push(const cv::Mat& coarse, Layer& fine) {
    cv::Mat larger;
    cv::pyrUp(coarse, larger, {2 * coarse.cols, 2 * coarse.rows});
    const int channels = fine.values.channels();
    parallel_for(0, fine.weight.rows, rows_a_task, [&](int first, int last) {
        for (int y = first; y < last; ++y) {
            const float* weight = fine.weight.ptr<float>(y);
            const float* more = larger.ptr<float>(y);
            float* value = fine.values.ptr<float>(y);
            for (int x = 0; x < fine.weight.cols; ++x) {
                for (int c = 0; c < channels; ++c) *value++ += (1 - weight[x]) * *more++;
            }
        }
    });
}

}  // namespace

cv::Mat membrane(const cv::Mat& values, const cv::Mat& known) {
    std::vector<Layer> layers(1);
    cv::Mat(known > 0).convertTo(layers[0].weight, CV_32F, 1 / 255.0);
    layers[0].values = values.clone();
    multiply_rows(layers[0].values, layers[0].weight);
    double least = 0;
    while (cv::minMaxLoc(layers.back().weight, &least), least < 1) layers.push_back(pulled(layers.back()));
    for (std::size_t i = layers.size() - 1; i > 0; --i) push(layers[i].values, layers[i - 1]);
    values.copyTo(layers[0].values, known);
    return layers[0].values;
}

}  // namespace puppetwarp
