#include <puppetwarp/project/weight_colours.h>

#include <puppetwarp/mesh/operators.h>

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace puppetwarp {

namespace {

constexpr std::array<Rgb, 9> inside_ramp{{{255, 255, 255},
                                          {255, 243, 178},
                                          {254, 217, 118},
                                          {254, 178, 76},
                                          {253, 141, 60},
                                          {252, 78, 42},
                                          {227, 26, 28},
                                          {189, 0, 38},
                                          {128, 0, 38}}};
constexpr std::array<Rgb, 5> below_ramp{
    {{222, 235, 247}, {158, 202, 225}, {107, 174, 214}, {33, 113, 181}, {8, 48, 107}}};
constexpr std::array<Rgb, 3> above_ramp{{{90, 0, 110}, {140, 20, 190}, {200, 90, 255}}};
constexpr double outside_range = 0.3;  // where the outer ramps end
constexpr double line_step = 0.1;
constexpr Rgb line_colour{60, 40, 40};
constexpr double line_width_px = 1.3;
constexpr double middle_width_px = 3;
// A weight that changes by less in a pixel is level, whatever round-off says: it has no iso-lines.
constexpr double level_slope = 1e-6;

constexpr TextStyle legend_text{8, false, {70, 70, 70}};
constexpr Rgb border_colour{110, 110, 110};
constexpr int ramp_height = 14;
constexpr int widest_legend = 520;
constexpr int above_legend = 10;
constexpr int tick_px = 4;

Rgb mixed(const Rgb& a, const Rgb& b, double share) {
    Rgb rgb{};
    for (std::size_t c = 0; c < 3; ++c) {
        rgb[c] = static_cast<std::uint8_t>(std::lround(a[c] + share * (static_cast<double>(b[c]) - a[c])));
    }
    return rgb;
}

// \param depth  0 to 1.
template <std::size_t stops>
Rgb ramp_colour(const std::array<Rgb, stops>& ramp, double depth) {
    const double place = std::clamp(depth, 0.0, 1.0) * (stops - 1);
    const std::size_t stop = std::min(static_cast<std::size_t>(place), stops - 2);
    return mixed(ramp[stop], ramp[stop + 1], place - static_cast<double>(stop));
}

// How much of a pixel an iso-line covers. \param slope  of the weight, per pixel.
double line_cover(double weight, double slope) {
    if (!(slope > level_slope)) return 0;
    const double nearest = std::clamp(std::round(weight / line_step), 1.0, 9.0);
    const double width = nearest == 5 ? middle_width_px : line_width_px;
    const double distance = std::abs(weight - nearest * line_step);
    return std::clamp(width / 2 + 0.5 - distance / slope, 0.0, 1.0);
}

cv::Scalar scalar(const Rgb& rgb) {
    return {static_cast<double>(rgb[0]), static_cast<double>(rgb[1]), static_cast<double>(rgb[2])};
}

// Fills one triangle.
// \param corners  3 x 2, pixels of the picture.   \param slope  of the weight, per pixel.
void fill(cv::Mat& picture, const Eigen::Matrix<double, 3, 2>& corners, const Eigen::Vector3d& weights, double slope) {
    const Eigen::RowVector2d a = corners.row(0), ab = corners.row(1) - a, ac = corners.row(2) - a;
    const double area = ab.x() * ac.y() - ab.y() * ac.x();
    if (area == 0) return;
    const auto first = [](double low) { return static_cast<int>(std::ceil(low - 0.5)); };
    const int left = std::max(0, first(corners.col(0).minCoeff())), top = std::max(0, first(corners.col(1).minCoeff()));
    const int right = std::min(picture.cols - 1.0, std::floor(corners.col(0).maxCoeff() - 0.5));
    const int bottom = std::min(picture.rows - 1.0, std::floor(corners.col(1).maxCoeff() - 0.5));
    for (int y = top; y <= bottom; ++y) {
        auto* row = picture.ptr<cv::Vec3b>(y);
        for (int x = left; x <= right; ++x) {
            const Eigen::RowVector2d p = Eigen::RowVector2d(x + 0.5, y + 0.5) - a;
            const double v = (p.x() * ac.y() - p.y() * ac.x()) / area, w = (ab.x() * p.y() - ab.y() * p.x()) / area;
            constexpr double on_edge = -1e-9;
            if (v < on_edge || w < on_edge || v + w > 1 - on_edge) continue;
            const double weight = weights(0) + v * (weights(1) - weights(0)) + w * (weights(2) - weights(0));
            const Rgb rgb = mixed(weight_colour(weight), line_colour, line_cover(weight, slope));
            row[x] = {rgb[0], rgb[1], rgb[2]};
        }
    }
}

}  // namespace

Rgb weight_colour(double weight) {
    // Round-off is no sign.
    constexpr double round_off = 1e-9;
    if (weight < -round_off) return ramp_colour(below_ramp, -weight / outside_range);
    if (weight > 1 + round_off) return ramp_colour(above_ramp, (weight - 1) / outside_range);
    return ramp_colour(inside_ramp, weight);
}

void draw_weight(cv::Mat& picture, const TriangleMesh& mesh, const Eigen::VectorXd& weight, const Canvas& canvas,
                 double scale) {
    const Eigen::MatrixX3cd gradients = hat_gradients(mesh);
    const Eigen::RowVector2d origin(canvas.x, canvas.y);
    for (Eigen::Index t = 0; t < mesh.F.rows(); ++t) {
        Eigen::Matrix<double, 3, 2> corners;
        Eigen::Vector3d weights;
        std::complex<double> gradient = 0;
        for (int k = 0; k < 3; ++k) {
            corners.row(k) = (mesh.V.row(mesh.F(t, k)) - origin) * scale;
            weights(k) = weight(mesh.F(t, k));
            gradient += weights(k) * gradients(t, k);
        }
        fill(picture, corners, weights, std::abs(gradient) / scale);
    }
}

int weight_legend_height() {
    return above_legend + ramp_height + 2 * tick_px + legend_text.line_px();
}

void draw_weight_legend(cv::Mat& picture, int x, int y, int width_px) {
    const int width = std::min(width_px, widest_legend);
    constexpr double low = -outside_range, high = 1 + outside_range;
    const cv::Rect place(x, y + above_legend, width, ramp_height);
    for (int column = 0; column < width; ++column) {
        const double weight = low + (high - low) * (column + 0.5) / width;
        const double slope = (high - low) / width;
        const Rgb rgb = mixed(weight_colour(weight), line_colour, line_cover(weight, slope));
        picture(cv::Rect(x + column, place.y, 1, ramp_height)).setTo(scalar(rgb));
    }
    cv::rectangle(picture, place, scalar(border_colour), 1);
    for (const double tick : {low, 0.0, 0.5, 1.0, high}) {
        std::array<char, 16> text{};
        std::snprintf(text.data(), text.size(), "%g", tick);
        const int centre = x + static_cast<int>(std::lround((width - 1) * (tick - low) / (high - low)));
        const int text_px = text_width(text.data(), legend_text);
        picture(cv::Rect(centre, place.y + ramp_height, 1, tick_px)).setTo(scalar(border_colour));
        draw_text(picture, text.data(), legend_text, std::clamp(centre - text_px / 2, x, x + width - text_px),
                  place.y + ramp_height + 2 * tick_px);
    }
}

}  // namespace puppetwarp
