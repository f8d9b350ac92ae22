#pragma once

#include <puppetwarp/base/point.h>

#include <opencv2/core/mat.hpp>

#include <vector>

namespace puppetwarp {

//! The share of each pixel's square that is inside the polygons by the even-odd rule, exact up to rounding for
//! polygons that do not cross. #rows x #cols, CV_8U, 255 = all of it.
cv::Mat polygon_coverage(const std::vector<Polyline>& polygons, int width, int height);

}  // namespace puppetwarp
