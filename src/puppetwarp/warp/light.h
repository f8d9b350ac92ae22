#pragma once

#include <puppetwarp/base/image.h>

#include <cstdint>
#include <vector>

namespace puppetwarp::detail {

//! A picture's tone curves as tables, between whole numbers and linear light in [0, 255] or [0, 65535].
class LightTables {
public:
    //! \param image  of 8 or 16 bits.
    explicit LightTables(const Image& image);

    //! The light of each value of a colour channel; rises strictly, so that `encode` gives each value back.
    const float* decode(int channel) const { return curve(channel).light.data(); }

    //! The value whose light, half a value more or less, holds `light`.
    int encode(int channel, float light) const;

private:
    struct Curve {
        std::vector<float> light;   // of value i
        std::vector<float> limits;  // between values i and i + 1
        std::vector<std::uint16_t>
            buckets;  // how many limits lie at or below bucket i's lower end; one more at the end
    };

    const Curve& curve(int channel) const {
        return curves_[curves_.size() == 1 ? 0 : static_cast<std::size_t>(channel)];
    }

    float full_;
    float buckets_a_unit_;
    std::vector<Curve> curves_;
};

}  // namespace puppetwarp::detail
