#include "model/rest_finder.h"

namespace puppetwarp::ui {

std::optional<Point> RestFinder::rest_from_moved(const std::shared_ptr<const Shape>& shape, const Point& moved) {
    if (shape != shape_) {
        locator_.reset();
        shape_ = shape;
    }
    if (!shape || !shape->mesh || shape->mesh->F.rows() == 0) return std::nullopt;
    if (!locator_) locator_.emplace(TriangleMesh{shape->moved, shape->mesh->F});
    const MeshLocation location = locator_->locate(moved);
    if (location.distance_px > 0) return std::nullopt;
    Point rest(0, 0);
    for (int k = 0; k < 3; ++k)
        rest += location.barycentric(k) * shape->mesh->V.row(shape->mesh->F(location.triangle, k)).transpose();
    return rest;
}

}  // namespace puppetwarp::ui
