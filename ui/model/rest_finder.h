#pragma once

#include "model/shape.h"

#include <puppetwarp/mesh/locate.h>

#include <memory>
#include <optional>

namespace puppetwarp::ui {

//! Answers where a point that is seen on the moved picture rests; quick while the shape stays the same.
class RestFinder {
public:
    //! \return null outside the moved mesh. \param shape  may be null.
    std::optional<Point> rest_from_moved(const std::shared_ptr<const Shape>& shape, const Point& moved);

private:
    std::shared_ptr<const Shape> shape_;  // what locator_ was made of
    std::optional<MeshLocator> locator_;
};

}  // namespace puppetwarp::ui
