#include <puppetwarp/project/sheet_cell.h>

#include <puppetwarp/image/convert.h>
#include <puppetwarp/project/distortion_colours.h>
#include <puppetwarp/project/overlay.h>
#include <puppetwarp/rig/depth.h>
#include <puppetwarp/warp/warp.h>

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace puppetwarp {

namespace {

constexpr int oversampling = 2;    // pictures are drawn this much larger, then averaged
constexpr int square_px = 8;       // of the chequered ground
constexpr int light_square = 255;  // its two levels
constexpr int dark_square = 238;

constexpr int column_gap_px = 6;  // between the two columns of numbers

const TextStyle title_style{10, true, {20, 20, 20}};
const TextStyle line_style{8.5, false, {70, 70, 70}};
const TextStyle alarm_style{8.5, true, {200, 0, 30}};
const cv::Scalar error_ground(247, 243, 240);

// 8-bit picture of 1 to 4 channels laid over an 8-bit RGB one of its size.
void lay_over_ground(const cv::Mat& picture, cv::Mat& ground) {
    const int channels = picture.channels();
    const bool alpha = channels % 2 == 0;
    for (int y = 0; y < picture.rows; ++y) {
        const std::uint8_t* pixel = picture.ptr<std::uint8_t>(y);
        auto* under = ground.ptr<cv::Vec3b>(y);
        for (int x = 0; x < picture.cols; ++x, pixel += channels) {
            const int over = alpha ? pixel[channels - 1] : 255;
            for (int c = 0; c < 3; ++c) {
                const int value = pixel[channels < 3 ? 0 : c];
                under[x][c] = static_cast<std::uint8_t>((value * over + under[x][c] * (255 - over) + 127) / 255);
            }
        }
    }
}

std::string formatted(const char* format, double value) {
    char text[64];
    std::snprintf(text, sizeof text, format, value);
    return text;
}

// What a person should know before believing the picture.
std::string note_on(const MethodResult& result) {
    if (!result.report.converged) return result.cut_off ? "open, cut off" : "not converged";
    return result.cut_off ? "cut off" : "";
}

// Three digits or more, and no exponents but for what is huge.
std::string readable(double value) {
    return formatted(value < 10 ? "%.2f" : value < 100 ? "%.1f" : value < 1e6 ? "%.0f" : "%.3g", value);
}

// One line, in a smaller size where it is too long, cut off where it still is.
void write_fitting(cv::Mat& sheet, const std::string& text, TextStyle style, int x, int y, int width) {
    const double smallest = 0.8 * style.height_px;
    while (text_width(text, style) > width && style.height_px > smallest) style.height_px -= 0.5;
    for (const std::string& line : wrapped(text, style, width, 1)) draw_text(sheet, line, style, x, y);
}

}  // namespace

CellPainter::CellPainter(const Image& subject, const TriangleMesh& mesh, const Rig& rig, const Canvas& canvas,
                         int width, int height)
    : subject_(subject),
      mesh_(mesh),
      rig_(rig),
      canvas_(canvas),
      width_(width),
      height_(height),
      scale_(static_cast<double>(oversampling) * std::max(width, height) / std::max(canvas.width, canvas.height)) {}

cv::Mat CellPainter::ground() const {
    constexpr int square = oversampling * square_px;
    cv::Mat ground(oversampling * height_, oversampling * width_, CV_8UC3);
    for (int y = 0; y < ground.rows; ++y) {
        for (int x = 0; x < ground.cols; ++x) {
            ground.at<cv::Vec3b>(y, x) = cv::Vec3b::all((x / square + y / square) % 2 ? dark_square : light_square);
        }
    }
    return ground;
}

cv::Mat CellPainter::finished(Image& drawn, const Pose& pose) const {
    draw_handles(drawn, rig_, pose, canvas_, scale_);
    cv::Mat picture;
    cv::resize(drawn.pixels, picture, {width_, height_}, 0, 0, cv::INTER_AREA);
    return picture;
}

cv::Mat CellPainter::warped(const Eigen::MatrixX2d& moved, const Pose& pose, Progress& progress) const {
    const Eigen::RowVector2d origin(canvas_.x, canvas_.y);
    const Eigen::MatrixX2d placed = (moved.rowwise() - origin) * scale_;
    const Canvas large{0, 0, oversampling * width_, oversampling * height_};
    WarpOptions how{Interpolation::bicubic, large};
    how.depth = vertex_depths(mesh_, rig_, pose);
    const Image picture = warp(subject_, mesh_, placed, how, progress);
    Image drawn;
    drawn.pixels = ground();
    lay_over_ground(to_depth(picture.pixels, CV_8U), drawn.pixels);
    return finished(drawn, pose);
}

cv::Mat CellPainter::distortion(const Eigen::MatrixX2d& moved, const Pose& pose) const {
    Image drawn;
    drawn.pixels = ground();
    draw_distortion(drawn.pixels, mesh_, moved, canvas_, scale_);
    return finished(drawn, pose);
}

int cell_text_height(bool timings) {
    return title_style.line_px() + (timings ? 3 : 2) * line_style.line_px();
}

void write_result(cv::Mat& sheet, const MethodResult& result, bool timings, const cv::Rect& place) {
    write_fitting(sheet, result.label, title_style, place.x, place.y, place.width);
    if (!result.error.empty()) {
        write_fitting(sheet, "cannot take this pose", alarm_style, place.x, place.y + title_style.line_px(),
                      place.width);
        return;
    }
    const RenderReport& report = result.report;
    const int folds = report.distortion.flipped_triangles;
    const int left_width = place.width * 56 / 100;  // energies are the longest words
    int y = place.y + title_style.line_px();
    const auto write_pair = [&](const std::string& left, bool left_alarms, const std::string& right,
                                bool right_alarms) {
        write_fitting(sheet, left, left_alarms ? alarm_style : line_style, place.x, y, left_width - column_gap_px);
        write_fitting(sheet, right, right_alarms ? alarm_style : line_style, place.x + left_width, y,
                      place.width - left_width);
        y += line_style.line_px();
    };
    write_pair("folds " + std::to_string(folds), folds > 0, "stretch " + readable(report.distortion.max_stretch),
               false);
    write_pair("energy " + formatted("%.4g", report.energy), false, note_on(result), true);
    if (!timings) return;
    std::vector<std::string> times;
    for (const auto& [stage, ms] : report.timings_ms) times.push_back(stage + " " + readable(ms) + " ms");
    write_pair(times.at(0), false, times.at(1), false);
}

void write_lines(cv::Mat& sheet, const std::string& title, const std::vector<std::string>& lines,
                 const cv::Rect& place) {
    write_fitting(sheet, title, title_style, place.x, place.y, place.width);
    int y = place.y + title_style.line_px();
    for (const std::string& line : lines) {
        write_fitting(sheet, line, line_style, place.x, y, place.width);
        y += line_style.line_px();
    }
}

void write_error(cv::Mat& sheet, const std::string& error, const cv::Rect& place) {
    sheet(place).setTo(error_ground);
    const int inset = 10;
    const int lines = std::max(1, (place.height - 2 * inset) / line_style.line_px());
    int y = place.y + inset;
    for (const std::string& line : wrapped(error, line_style, place.width - 2 * inset, lines)) {
        draw_text(sheet, line, line_style, place.x + inset, y);
        y += line_style.line_px();
    }
}

}  // namespace puppetwarp
