#include "model/view_transform.h"

#include <algorithm>

namespace puppetwarp::ui {

void ViewTransform::zoom_about(const Point& screen, double factor) {
    const Point held = image_from_screen(screen);
    scale_ = std::clamp(scale_ * factor, min_scale, max_scale);
    origin_ = screen - held * scale_;
}

void ViewTransform::set_scale(double scale, const ScreenRect& viewport) {
    zoom_about(viewport.centre(), scale / scale_);
}

void ViewTransform::fit(double image_width, double image_height, const ScreenRect& viewport) {
    constexpr double margin = 0.92;
    constexpr double max_fit_scale = 4;
    const double room = std::min(viewport.size.x() / image_width, viewport.size.y() / image_height);
    scale_ = std::clamp(std::min(room * margin, max_fit_scale), min_scale, max_scale);
    origin_ = viewport.centre() - Point(image_width, image_height) / 2 * scale_;
}

}  // namespace puppetwarp::ui
