#include <puppetwarp/deform/rigid_blend.h>

#include <algorithm>

namespace puppetwarp {

Eigen::VectorXcd blend_shears(const WeightRows& W, const Eigen::VectorXcd& z, const std::vector<SplitMotion>& motions) {
    if (std::all_of(motions.begin(), motions.end(), [](const SplitMotion& each) { return each.mu == 0.0; })) return z;
    std::vector<AffineMap> shears;
    shears.reserve(motions.size());
    for (const SplitMotion& each : motions) shears.push_back({1, each.mu, -each.mu * std::conj(each.centre)});
    return linear_blend(W, z, shears);
}

}  // namespace puppetwarp
