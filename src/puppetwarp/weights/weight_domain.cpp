#include <puppetwarp/weights/weight_domain.h>

namespace puppetwarp {

WeightDomain weight_domain(const TriangleMesh& mesh, const Rig&) {
    return {mesh, std::nullopt};
}

}  // namespace puppetwarp
