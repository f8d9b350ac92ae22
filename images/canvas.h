#pragma once

#include "shapes.h"

#include <puppetwarp/base/image.h>

#include <opencv2/core.hpp>

#include <functional>

//! A painter's tools: shapes become relief, relief becomes light and shade, layers are laid over each other.
namespace samples {

using Field = cv::Mat1f;  //!< one number a pixel: a signed distance, a height, a coverage
using Paint = cv::Mat3f;  //!< colour a pixel, RGB, 0 to 1

cv::Vec3f rgb(unsigned hex);  //!< 0xrrggbb

//! Evaluates at each pixel's centre, in parallel.
Field field(cv::Size size, const std::function<float(Vec)>& value);
Paint paint(cv::Size size, const std::function<cv::Vec3f(Vec)>& colour);

//! How much of each pixel lies inside a shape. \param softness  width of the edge in px.
Field coverage(const Field& distance, float softness = 1.2F);
Field blurred(const Field& values, float sigma_px);
Field moved(const Field& values, Vec by);  //!< by whole pixels, 0 flows in

//! Height over the ground of a shape whose rim is rounded over `rim_px`.
Field dome(const Field& distance, float rim_px, float height_px);

//! How a surface answers light from the upper left.
struct Surface {
    float contrast = 0.9F;   //!< of light against shade; level ground is left as painted
    float highlight = 0.2F;  //!< strength of the mirror image of the lamp
    float gloss = 24;        //!< how small it is
    cv::Vec3f lamp{1, 0.98F, 0.93F};
};
Paint lit(const Paint& colour, const Field& height, const Surface& surface);

//! Layers over each other, with alpha.
class Canvas {
public:
    explicit Canvas(cv::Size size);

    cv::Size size() const { return alpha_.size(); }
    //! Lays colour over what is there.
    void lay(const Paint& colour, const Field& cover);
    void lay(const cv::Vec3f& colour, const Field& cover);
    //! As `lay`, but only where something is already: a shadow on it, a pattern, a gleam.
    void lay_inside(const Paint& colour, const Field& cover);
    void lay_inside(const cv::Vec3f& colour, const Field& cover);

    //! \param depth  CV_8U or CV_16U. \param with_alpha  false: over black, as opaque RGB.
    puppetwarp::Image image(int depth, bool with_alpha) const;

private:
    Paint premultiplied_;
    Field alpha_;
};

}  // namespace samples
