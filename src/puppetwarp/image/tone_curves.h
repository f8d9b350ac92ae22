#pragma once

#include <puppetwarp/base/image.h>

#include <functional>
#include <vector>

namespace puppetwarp {

//! How much light an encoded value stands for: from [0, 1] to [0, 1], never falling.
using ToneCurve = std::function<double(double encoded)>;

//! IEC 61966-2-1.
double srgb_light(double encoded);

//! The curves of a picture's colour channels, one for all or one each: those of its ICC profile (curveType and
//! parametricCurveType of ICC.1:2022); sRGB's where it has no profile, or one without curves.
std::vector<ToneCurve> tone_curves(const Image& image);

}  // namespace puppetwarp
