#pragma once

#include <opencv2/core/matx.hpp>
#include <opencv2/core/types.hpp>

#include <vector>

//! Shapes as signed distances in pixels: negative inside, positive outside.
namespace samples {

using Vec = cv::Point2f;

float length(Vec v);
Vec direction(float degrees);  //!< of length 1; 0 points right, 90 down

//! 0 below `from`, 1 above `to`, smooth in between; `from` may be the larger one.
float smooth_step(float from, float to, float value);
float mix(float a, float b, float share);
cv::Vec3f mix(const cv::Vec3f& a, const cv::Vec3f& b, float share);

float circle(Vec p, Vec centre, float radius);
//! Approximate away from the outline. \param degrees  turn of the axes.
float ellipse(Vec p, Vec centre, Vec radii, float degrees = 0);
float rounded_box(Vec p, Vec centre, Vec half_size, float corner);
//! A bone with round ends of two sizes.
float capsule(Vec p, Vec a, Vec b, float radius_a, float radius_b);
//! Convex or not, corners in order.
float polygon(Vec p, const std::vector<Vec>& corners);

//! The union of two shapes, their inner corner filled with a fillet of about this size.
float join(float a, float b, float fillet);

struct CurvePoint {
    Vec at;
    float radius = 0;
};

//! Points joined by straight pieces, with a radius at each.
class Curve {
public:
    explicit Curve(std::vector<CurvePoint> points);

    const std::vector<CurvePoint>& points() const { return points_; }
    //! From one point to another, both inclusive.
    Curve part(std::size_t first, std::size_t last) const;
    //! How far outside the box around all of it p lies; 0 inside.
    float distance_to_box(Vec p) const;

private:
    std::vector<CurvePoint> points_;
    Vec low_, high_;
};

//! Catmull-Rom through the knots, `steps` pieces between two.
Curve smooth_curve(const std::vector<CurvePoint>& knots, int steps = 12);

//! Where on a curve the point nearest to p lies.
struct CurvePlace {
    float distance = 0;  //!< signed, to the curve's surface
    float along = 0;     //!< length from the start, px
    float across = 0;    //!< -1 to 1 from the left edge to the right edge
    float radius = 0;
};
//! More than 64 px outside the curve's box only `distance` is set, and is at most the true one.
CurvePlace nearest_on_curve(Vec p, const Curve& curve);
float tube(Vec p, const Curve& curve);
//! Height of a round tube over the plane of its axis.
float tube_height(const CurvePlace& place);

}  // namespace samples
