#include <puppetwarp/project/overlay.h>

#include <puppetwarp/rig/handle_maps.h>

#include <opencv2/imgproc.hpp>

#include <array>
#include <cmath>
#include <set>
#include <utility>

namespace puppetwarp {

namespace {

constexpr int fraction_bits = 4;  // OpenCV draws with sub-pixel ends as fixed-point numbers
constexpr std::array<double, 3> mesh_colour{0.10, 0.45, 0.95};

// Coverage of antialiased strokes, 8 bits: drawn once, then blended into pictures of any depth.
class Strokes {
public:
    //! \param picture  that is drawn over: its upper left corner shows `origin`, at `scale`.
    Strokes(const Image& picture, const Point& origin, double scale)
        : origin_(origin), scale_(scale), coverage_(cv::Mat::zeros(picture.height(), picture.width(), CV_8UC1)) {}

    void line(const Point& a, const Point& b, int thickness) {
        cv::Point2l p = fixed(a), q = fixed(b);
        // Clipped before OpenCV narrows the numbers to int; a margin keeps line ends outside the picture.
        const std::int64_t margin = std::int64_t{64} << fraction_bits;
        p += cv::Point2l(margin, margin);
        q += cv::Point2l(margin, margin);
        const cv::Size2l room((std::int64_t{coverage_.cols} << fraction_bits) + 2 * margin,
                              (std::int64_t{coverage_.rows} << fraction_bits) + 2 * margin);
        if (!cv::clipLine(room, p, q)) return;
        cv::line(coverage_, narrow(p, margin), narrow(q, margin), cv::Scalar(255), thickness, cv::LINE_AA,
                 fraction_bits);
    }

    void disc(const Point& centre, double radius_px) {
        const cv::Point2l p = fixed(centre);
        const std::int64_t reach = (std::int64_t{1} << 24);
        if (std::abs(p.x) > reach || std::abs(p.y) > reach) return;
        cv::circle(coverage_, narrow(p, 0), static_cast<int>(std::lround(radius_px * (1 << fraction_bits))),
                   cv::Scalar(255), cv::FILLED, cv::LINE_AA, fraction_bits);
    }

    const cv::Mat& coverage() const { return coverage_; }

private:
    // OpenCV's pixel (i, j) is centred on (i, j), ours on (i + 0.5, j + 0.5).
    cv::Point2l fixed(const Point& p) const {
        const double limit = 1e12;
        const auto coordinate = [&](double value, double origin) {
            return std::llround(std::clamp(((value - origin) * scale_ - 0.5) * (1 << fraction_bits), -limit, limit));
        };
        return {coordinate(p.x(), origin_.x()), coordinate(p.y(), origin_.y())};
    }
    static cv::Point narrow(const cv::Point2l& p, std::int64_t margin) {
        return {static_cast<int>(p.x - margin), static_cast<int>(p.y - margin)};
    }

    Point origin_;
    double scale_;
    cv::Mat coverage_;
};

// The colour's value for one of the picture's colour channels: grey pictures get its luma.
double channel_value(const std::array<double, 3>& rgb, int channel, int colour_channels) {
    return colour_channels == 1 ? 0.299 * rgb[0] + 0.587 * rgb[1] + 0.114 * rgb[2]
                                : rgb[static_cast<std::size_t>(channel)];
}

template <typename Value>
void blend_row(Value* pixel, const std::uint8_t* coverage, int width, const Image& picture,
               const std::array<double, 3>& rgb) {
    const int channels = picture.pixels.channels();
    const int colours = picture.has_alpha() ? channels - 1 : channels;
    const double full = picture.full_value();
    const auto rounded = [](double value) {
        return std::is_integral_v<Value> ? static_cast<Value>(std::lround(value)) : static_cast<Value>(value);
    };
    for (int x = 0; x < width; ++x, pixel += channels) {
        if (coverage[x] == 0) continue;
        const double over = coverage[x] / 255.0;
        const double under = (picture.has_alpha() ? pixel[colours] / full : 1.0) * (1 - over);
        for (int c = 0; c < colours; ++c) {
            pixel[c] = rounded((channel_value(rgb, c, colours) * full * over + pixel[c] * under) / (over + under));
        }
        if (picture.has_alpha()) pixel[colours] = rounded(full * (over + under));
    }
}

void blend(Image& picture, const Strokes& strokes, const std::array<double, 3>& rgb) {
    for (int y = 0; y < picture.height(); ++y) {
        const std::uint8_t* coverage = strokes.coverage().ptr<std::uint8_t>(y);
        switch (picture.pixels.depth()) {
            case CV_8U: blend_row(picture.pixels.ptr<std::uint8_t>(y), coverage, picture.width(), picture, rgb); break;
            case CV_16U:
                blend_row(picture.pixels.ptr<std::uint16_t>(y), coverage, picture.width(), picture, rgb);
                break;
            default: blend_row(picture.pixels.ptr<float>(y), coverage, picture.width(), picture, rgb); break;
        }
    }
}

// Sizes of strokes grow with the picture, so that they stay visible when a large one is looked at whole.
double stroke_unit(const Image& picture) {
    return std::max(1.0, std::hypot(picture.width(), picture.height()) / 1200.0);
}

// The points a handle shows in a pose: where it is dragged, else where it rests.
struct PosedPoints {
    const HandlePose& pose;
    const AffineMap& map;

    Polyline operator()(const PointHandle& handle) const { return {moved(handle.at)}; }
    Polyline operator()(const BoneHandle& handle) const { return {moved(handle.from), moved(handle.to)}; }
    Polyline operator()(const CageHandle& handle) const { return closed(pose.points.value_or(handle.points)); }
    Polyline operator()(const RegionHandle& handle) const {
        Polyline points;
        for (const Point& p : handle.points) points.push_back(moved(p));
        return closed(points);
    }
    Polyline operator()(const VertexHandle&) const { return pose.to ? Polyline{*pose.to} : Polyline{}; }

    Point moved(const Point& p) const {
        const std::complex<double> q = map({p.x(), p.y()});
        return {q.real(), q.imag()};
    }
    static Polyline closed(Polyline points) {
        if (!points.empty()) points.push_back(points.front());
        return points;
    }
};

Point corner_of(const Canvas& canvas) {
    return {canvas.x, canvas.y};
}

void draw_handles_from(const Point& origin, double scale, Image& picture, const Rig& rig, const Pose& pose,
                       const HandleStyle& style) {
    const double unit = stroke_unit(picture) * style.size;
    const auto thickness = [&](double width) { return std::max(1, static_cast<int>(std::lround(width * unit))); };
    const HandlePose at_rest;
    Strokes rims(picture, origin, scale), bodies(picture, origin, scale);
    const std::vector<AffineMap> maps = handle_maps(rig, pose);
    for (std::size_t h = 0; h < rig.handles.size(); ++h) {
        const Handle& handle = rig.handles[h];
        const auto found = pose.handles.find(handle.id);
        const HandlePose& posed = found == pose.handles.end() ? at_rest : found->second;
        const Polyline points = std::visit(PosedPoints{posed, maps[h]}, handle.shape);
        for (std::size_t i = 0; i + 1 < points.size(); ++i) {
            rims.line(points[i], points[i + 1], thickness(4));
            bodies.line(points[i], points[i + 1], thickness(2));
        }
        for (const Point& p : points) {
            rims.disc(p, 7 * unit);
            bodies.disc(p, 5 * unit);
        }
    }
    blend(picture, rims, style.rim);
    blend(picture, bodies, style.body);
}

}  // namespace

void draw_mesh(Image& picture, const Eigen::MatrixX2d& positions, const Eigen::MatrixX3i& F, const Canvas& canvas) {
    std::set<std::pair<int, int>> edges;
    for (Eigen::Index t = 0; t < F.rows(); ++t) {
        for (int k = 0; k < 3; ++k) edges.insert(std::minmax({F(t, k), F(t, (k + 1) % 3)}));
    }
    Strokes strokes(picture, corner_of(canvas), 1);
    const int thickness = static_cast<int>(std::lround(stroke_unit(picture)));
    for (const auto& [a, b] : edges) strokes.line(positions.row(a), positions.row(b), thickness);
    blend(picture, strokes, mesh_colour);
}

void draw_handles(Image& picture, const Rig& rig, const Pose& pose, const Canvas& canvas, double scale,
                  const HandleStyle& style) {
    draw_handles_from(corner_of(canvas), scale, picture, rig, pose, style);
}

void draw_mesh(Rendered& rendered) {
    draw_mesh(rendered.image, rendered.moved.array().rowwise() * (rendered.resolution * rendered.scale).array(),
              rendered.mesh.F, rendered.report.canvas);
}

void draw_handles(Rendered& rendered, const Pose& pose) {
    const double scale = rendered.report.scale;
    draw_handles_from(corner_of(rendered.report.canvas) / scale, scale, rendered.image, rendered.rig, pose, {});
}

}  // namespace puppetwarp
