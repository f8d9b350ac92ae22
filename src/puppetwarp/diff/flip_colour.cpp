#include <puppetwarp/diff/flip_colour.h>

namespace puppetwarp {

LinearLight::LinearLight() {
    for (int i = 0; i <= kSteps; ++i) {
        const double encoded = static_cast<double>(i) / kSteps;
        values_.push_back(
            static_cast<float>(encoded > 0.04045 ? std::pow((encoded + 0.055) / 1.055, 2.4) : encoded / 12.92));
    }
}

}  // namespace puppetwarp
