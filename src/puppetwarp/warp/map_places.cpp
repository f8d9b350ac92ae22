#include <puppetwarp/warp/map_places.h>

#include <algorithm>
#include <cmath>

namespace puppetwarp::detail {

namespace {

using Step = std::optional<Point>;  // from a pixel of the map to its neighbour, in places

// Far outside of any picture, and small enough for fixed-point arithmetic.
constexpr double farthest_px = 1 << 28;

// Neighbours of the map belong to different parts when they lie so much farther apart than on the other side.
constexpr double tear_factor = 4;
constexpr double tear_px = 2;

bool is_tear(const Step& step, const Step& other_side) {
    return step && other_side && step->norm() > tear_factor * other_side->norm() + tear_px;
}

// What goes on in the direction of `step`: itself, or where it is a tear or there is none, the other side.
Point continued(const Step& step, const Step& other_side) {
    if (step && !is_tear(step, other_side)) return *step;
    return other_side ? Point(-*other_side) : Point(0, 0);
}

// The smaller of two one-sided differences: the other one may cross an edge.
Point smaller(const Step& after, const Step& before) {
    if (!after && !before) return {0, 0};
    if (!before || (after && after->squaredNorm() <= before->squaredNorm())) return *after;
    return -*before;
}

}  // namespace

// A pixel of the map, how far from its centre the output's pixel lies, and its neighbours.
struct MapPlaces::Node {
    std::int64_t x, y;
    double along_x, along_y;  // in [-1, 1] pixels of the map
    Point place;
    Step right, left, below, above;
    double shown;
};

MapPlaces::MapPlaces(const DisplacementMap& map, const Canvas& canvas, const Eigen::Array2d& magnification,
                     const Image& picture)
    : map_(map),
      canvas_(canvas),
      magnification_(magnification),
      same_size_((magnification == 1).all()),
      width_(picture.width()),
      height_(picture.height()),
      has_alpha_(picture.has_alpha()),
      resolution_(width_ / map.plane.source_width, height_ / map.plane.source_height) {}

std::optional<Point> MapPlaces::stored(std::int64_t x, std::int64_t y) const {
    if (x < 0 || y < 0 || x >= map_.displacement.cols || y >= map_.displacement.rows) return std::nullopt;
    const int column = static_cast<int>(x), row = static_cast<int>(y);
    const cv::Vec3f& displacement = map_.displacement.ptr<cv::Vec3f>(row)[column];
    if (!std::isfinite(displacement[0]) || !std::isfinite(displacement[1])) return std::nullopt;
    const Point at = map_.plane.place(column, row) + Point(displacement[0], displacement[1]);
    const Point place = (at.array() * resolution_).matrix();
    return place.lpNorm<Eigen::Infinity>() <= farthest_px ? std::optional(place) : std::nullopt;
}

double MapPlaces::stored_share(std::int64_t x, std::int64_t y) const {
    return static_cast<double>(map_.displacement.ptr<cv::Vec3f>(static_cast<int>(y))[static_cast<int>(x)][2]);
}

std::optional<MapPlaces::Node> MapPlaces::node(int column, int row) const {
    auto found = same_size_ ? node_at(column, row) : node_near(column, row);
    if (!found) return found;
    const auto step = [&](int dx, int dy) -> Step {
        const auto neighbour = stored(found->x + dx, found->y + dy);
        return neighbour ? Step(*neighbour - found->place) : std::nullopt;
    };
    found->right = step(1, 0);
    found->left = step(-1, 0);
    found->below = step(0, 1);
    found->above = step(0, -1);
    return found;
}

// The map's own pixel.
std::optional<MapPlaces::Node> MapPlaces::node_at(int column, int row) const {
    Node node{};
    node.x = std::int64_t{canvas_.x} + column - map_.plane.canvas.x;
    node.y = std::int64_t{canvas_.y} + row - map_.plane.canvas.y;
    const auto place = stored(node.x, node.y);
    if (!place) return std::nullopt;
    node.place = *place;
    node.shown = stored_share(node.x, node.y);
    return node;
}

// Of the four pixels of the map around a place the nearest that shows something. Pictures with alpha end by that: for
// them all that one of the four shows is shown, for others what they show by more than half.
std::optional<MapPlaces::Node> MapPlaces::node_near(int column, int row) const {
    const double x = (canvas_.x + (column + 0.5)) / magnification_.x() - map_.plane.canvas.x;
    const double y = (canvas_.y + (row + 0.5)) / magnification_.y() - map_.plane.canvas.y;
    if (!(x >= 0 && y >= 0 && x < map_.displacement.cols && y < map_.displacement.rows)) return std::nullopt;
    const auto left = static_cast<std::int64_t>(std::floor(x - 0.5)),
               top = static_cast<std::int64_t>(std::floor(y - 0.5));
    const double fx = x - 0.5 - static_cast<double>(left), fy = y - 0.5 - static_cast<double>(top);
    std::optional<Node> best;
    double most = 0, sum = 0, shown = 0;
    for (int k = 0; k < 4; ++k) {
        // Beyond its border the map goes on.
        const std::int64_t px = std::clamp<std::int64_t>(left + k % 2, 0, map_.displacement.cols - 1);
        const std::int64_t py = std::clamp<std::int64_t>(top + k / 2, 0, map_.displacement.rows - 1);
        const double weight = (k % 2 == 0 ? 1 - fx : fx) * (k / 2 == 0 ? 1 - fy : fy);
        const auto place = stored(px, py);
        if (!place || !(weight > 0)) continue;
        sum += weight;
        shown += weight * stored_share(px, py);
        if (weight <= most) continue;
        most = weight;
        best = Node{px, py, x - 0.5 - static_cast<double>(px), y - 0.5 - static_cast<double>(py), *place, {}, {}, {},
                    {}, 0};
    }
    if (!best || (!has_alpha_ && sum < 0.5)) return std::nullopt;
    best->shown = shown / sum;
    return best;
}

// Bilinear where the four pixels around belong together, else along the slopes of the nearest.
Point MapPlaces::between(const Node& node) const {
    if (node.along_x == 0 && node.along_y == 0) return node.place;
    const bool right = node.along_x >= 0, below = node.along_y >= 0;
    const double fx = std::abs(node.along_x), fy = std::abs(node.along_y);
    const Point x_step = right ? continued(node.right, node.left) : continued(node.left, node.right);
    const Point y_step = below ? continued(node.below, node.above) : continued(node.above, node.below);
    Point plane = node.place + fx * x_step + fy * y_step;
    const auto diagonal = stored(node.x + (right ? 1 : -1), node.y + (below ? 1 : -1));
    if (!diagonal) return plane;
    const Point twist = *diagonal - node.place - x_step - y_step;
    const bool belongs = twist.norm() <= (x_step.norm() + y_step.norm()) / 2 + 1;
    return belongs ? Point(plane + fx * fy * twist) : plane;
}

bool MapPlaces::is_in_picture(const Point& at) const {
    return at.x() >= -0.5 && at.y() >= -0.5 && at.x() <= width_ + 0.5 && at.y() <= height_ + 0.5;
}

bool MapPlaces::is_covered(int column, int row) const {
    const auto found = same_size_ ? node_at(column, row) : node(column, row);
    return found && found->shown >= 1 && is_in_picture(between(*found));
}

std::optional<ShownPlace> MapPlaces::shown(int column, int row) const {
    const auto found = node(column, row);
    if (!found) return std::nullopt;
    ShownPlace shown{between(*found), found->shown, {}};
    if (!is_in_picture(shown.at)) return std::nullopt;
    shown.slope << smaller(found->right, found->left), smaller(found->below, found->above);
    shown.slope.array().rowwise() /= magnification_.transpose();
    shown.slope = shown.slope.cwiseMax(-farthest_px).cwiseMin(farthest_px).eval();
    return shown;
}

}  // namespace puppetwarp::detail
