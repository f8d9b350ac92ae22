#pragma once

#include <puppetwarp/base/point.h>

namespace puppetwarp::ui {

//! A rectangle on the screen, in window coordinates.
struct ScreenRect {
    Point min{0, 0};
    Point size{0, 0};

    Point centre() const { return min + size / 2; }
    bool contains(const Point& screen) const {
        return screen.x() >= min.x() && screen.y() >= min.y() && screen.x() < min.x() + size.x() &&
               screen.y() < min.y() + size.y();
    }
};

//! Where image space lies on the screen: a zoom and a shift.
class ViewTransform {
public:
    static constexpr double min_scale = 1.0 / 64;
    static constexpr double max_scale = 64;

    //! Screen points for one image pixel.
    double scale() const { return scale_; }
    Point screen_from_image(const Point& image) const { return image * scale_ + origin_; }
    Point image_from_screen(const Point& screen) const { return (screen - origin_) / scale_; }
    double image_length_from_screen(double length) const { return length / scale_; }

    void pan(const Point& screen_delta) { origin_ += screen_delta; }
    //! Zooms so that what is under `screen` stays there; the scale stays within its limits.
    void zoom_about(const Point& screen, double factor);
    //! Sets the scale and keeps what is at the middle of `viewport` there.
    void set_scale(double scale, const ScreenRect& viewport);
    //! The whole picture in the middle of the viewport with a margin, enlarged at most fourfold.
    void fit(double image_width, double image_height, const ScreenRect& viewport);
    //! Keeps the middle of the old viewport in the middle of the new one.
    void follow(const ScreenRect& before, const ScreenRect& after) { pan(after.centre() - before.centre()); }

private:
    double scale_ = 1;
    Point origin_{0, 0};  // the screen point of image point (0, 0)
};

}  // namespace puppetwarp::ui
