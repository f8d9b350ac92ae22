#include <puppetwarp/project/distortion_colours.h>

#include <puppetwarp/base/point.h>
#include <puppetwarp/mesh/distortion.h>

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <utility>

namespace puppetwarp {

namespace {

using Ramp = std::array<Rgb, 6>;
constexpr Ramp reds{{{255, 255, 255}, {253, 219, 199}, {244, 165, 130}, {214, 96, 77}, {178, 24, 43}, {103, 0, 31}}};
constexpr Ramp blues{{{255, 255, 255}, {209, 229, 240}, {146, 197, 222}, {67, 147, 195}, {33, 102, 172}, {5, 48, 97}}};
constexpr Ramp greys{{{255, 255, 255}, {224, 224, 224}, {186, 186, 186}, {135, 135, 135}, {77, 77, 77}, {26, 26, 26}}};
constexpr Rgb fold_colour{255, 0, 255};
constexpr Rgb border_colour{110, 110, 110};
constexpr int fraction_bits = 4;

constexpr TextStyle legend_text{8, false, {70, 70, 70}};
constexpr int ramp_height = 14;
constexpr int widest_legend = 520;
constexpr int legend_gap = 8;
constexpr int ramp_gap = 4;
constexpr int above_legend = 10;

using Colour = std::array<double, 3>;

Colour mixed(const Colour& a, const Colour& b, double share) {
    Colour result{};
    for (std::size_t c = 0; c < 3; ++c) result[c] = a[c] + share * (b[c] - a[c]);
    return result;
}

// \param depth  0 for white to 1 for the darkest.
Colour ramp_colour(const Ramp& ramp, double depth) {
    const double place = std::clamp(depth, 0.0, 1.0) * (ramp.size() - 1);
    const std::size_t stop = std::min(static_cast<std::size_t>(place), ramp.size() - 2);
    const auto colour = [](const Rgb& rgb) {
        return Colour{static_cast<double>(rgb[0]), static_cast<double>(rgb[1]), static_cast<double>(rgb[2])};
    };
    return mixed(colour(ramp[stop]), colour(ramp[stop + 1]), place - static_cast<double>(stop));
}

cv::Scalar scalar(const Rgb& rgb) {
    return {static_cast<double>(rgb[0]), static_cast<double>(rgb[1]), static_cast<double>(rgb[2])};
}

// Image space to the fixed-point numbers that OpenCV draws with; its pixel (i, j) is centred on (i, j).
class Projection {
public:
    Projection(const Canvas& canvas, double scale) : origin_(canvas.x, canvas.y), scale_(scale) {}

    cv::Point operator()(const Point& p) const {
        constexpr double farthest = 1e6;  // what lies beyond, out of sight, still has to be a number to OpenCV
        const Point q = ((p - origin_) * scale_ - Point(0.5, 0.5)).cwiseMax(-farthest).cwiseMin(farthest);
        return {cvRound(q.x() * (1 << fraction_bits)), cvRound(q.y() * (1 << fraction_bits))};
    }

private:
    Point origin_;
    double scale_;
};

void draw_border(cv::Mat& picture, const TriangleMesh& mesh, const Eigen::MatrixX2d& moved,
                 const Projection& projected) {
    std::map<std::pair<int, int>, int> uses;
    for (Eigen::Index t = 0; t < mesh.F.rows(); ++t) {
        for (int k = 0; k < 3; ++k) ++uses[std::minmax({mesh.F(t, k), mesh.F(t, (k + 1) % 3)})];
    }
    for (const auto& [edge, count] : uses) {
        if (count > 1) continue;
        cv::line(picture, projected(moved.row(edge.first)), projected(moved.row(edge.second)), scalar(border_colour), 2,
                 cv::LINE_8, fraction_bits);
    }
}

// A ramp with its meaning before it.
void draw_ramp(cv::Mat& picture, const cv::Rect& place, double larger, double smaller, const char* meaning, int x) {
    draw_text(picture, meaning, legend_text, x, place.y + 3);
    for (int column = 0; column < place.width; ++column) {
        const double exponent = static_cast<double>(column) / (place.width - 1);
        const Rgb rgb = distortion_colour(std::pow(larger, exponent), std::pow(smaller, exponent));
        picture(cv::Rect(place.x + column, place.y, 1, place.height)).setTo(scalar(rgb));
    }
    cv::rectangle(picture, place, scalar(border_colour), 1);
}

// Numbers below the ramps, fewer where there is little room.
void draw_ticks(cv::Mat& picture, int x, int y, int width) {
    int free_from = x - width;
    for (const double tick : {1.0, 1.2, 1.4, 1.7, darkest_distortion}) {
        char text[16];
        std::snprintf(text, sizeof text, tick < darkest_distortion ? "%g" : "%g+", tick);
        const int text_px = text_width(text, legend_text);
        const int centre =
            x + static_cast<int>(std::lround((width - 1) * std::log(tick) / std::log(darkest_distortion)));
        if (centre - text_px / 2 < free_from) continue;
        picture(cv::Rect(centre, y, 1, 4)).setTo(scalar(border_colour));
        draw_text(picture, text, legend_text, centre - text_px / 2, y + 8);
        free_from = centre + text_px / 2 + legend_gap;
    }
}

}  // namespace

Rgb distortion_colour(double larger, double smaller) {
    if (!(smaller > 0)) return fold_colour;
    const double grown = std::max(0.0, std::log(larger));
    const double shrunk = std::max(0.0, -std::log(smaller));
    const double depth = std::max(grown, shrunk) / std::log(darkest_distortion);
    const double hue = grown + shrunk > 0 ? (grown - shrunk) / (grown + shrunk) : 0;  // -1 blue, 0 grey, 1 red
    const Colour colour = mixed(ramp_colour(greys, depth), ramp_colour(hue > 0 ? reds : blues, depth), std::abs(hue));
    Rgb rgb{};
    for (std::size_t c = 0; c < 3; ++c) rgb[c] = static_cast<std::uint8_t>(std::lround(colour[c]));
    return rgb;
}

void draw_distortion(cv::Mat& picture, const TriangleMesh& mesh, const Eigen::MatrixX2d& moved, const Canvas& canvas,
                     double scale) {
    const Eigen::MatrixX2d stretches = principal_stretches(mesh, moved);
    const Projection projected(canvas, scale);
    for (const bool folded : {false, true}) {
        for (Eigen::Index t = 0; t < mesh.F.rows(); ++t) {
            if (folded != !(stretches(t, 1) > 0)) continue;
            std::array<cv::Point, 3> corners;
            for (int k = 0; k < 3; ++k) corners[static_cast<std::size_t>(k)] = projected(moved.row(mesh.F(t, k)));
            cv::fillConvexPoly(picture, corners.data(), 3, scalar(distortion_colour(stretches(t, 0), stretches(t, 1))),
                               cv::LINE_8, fraction_bits);
        }
        if (!folded) draw_border(picture, mesh, moved, projected);
    }
}

int distortion_legend_height() {
    constexpr int ramps = 3;
    return above_legend + 2 * legend_text.line_px() + ramp_gap + ramps * (ramp_height + ramp_gap) + legend_gap +
           ramp_height;
}

void draw_distortion_legend(cv::Mat& picture, int x, int y, int width_px) {
    struct Row {
        const char* meaning;
        double larger, smaller;  // at the ramp's end
    };
    constexpr double most = darkest_distortion;
    constexpr std::array<Row, 3> rows{{{"grows", most, 1}, {"shears", most, 1 / most}, {"shrinks", 1, 1 / most}}};
    TextStyle title = legend_text;
    title.bold = true;
    const int width = std::min(width_px, widest_legend);
    const int top = y + above_legend;
    draw_text(picture, "distortion: max(s1, 1/s2)", title, x, top);
    const int left = x + text_width("shrinks", legend_text) + 2 * legend_gap;
    const int ramp_width = x + width - left - text_width("2+", legend_text) / 2;
    cv::Rect place(left, top + legend_text.line_px() + ramp_gap, ramp_width, ramp_height);
    for (const Row& row : rows) {
        draw_ramp(picture, place, row.larger, row.smaller, row.meaning, x);
        place.y += ramp_height + ramp_gap;
    }
    draw_ticks(picture, left, place.y - ramp_gap, ramp_width);
    place.y += legend_text.line_px() + legend_gap;
    place.width = 3 * ramp_height;
    picture(place).setTo(scalar(fold_colour));
    draw_text(picture, "folds", legend_text, x, place.y + 3);
}

}  // namespace puppetwarp
