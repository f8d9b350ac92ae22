#pragma once
// Private header.

#include <puppetwarp/mesh/triangle_mesh.h>
#include <puppetwarp/rig/binding.h>

#include <vector>

namespace puppetwarp {

//! The parts of a mesh that no handle holds: each follows the handles of the others as one rigid body, by the moving
//! least squares map at its centroid (Schaefer et al. 2006, weights 1 / d^2).
class LooseComponents {
public:
    LooseComponents(const TriangleMesh& mesh, const std::vector<Hold>& holds);

    //! Whether a vertex belongs to a loose part. #V
    const std::vector<bool>& loose() const { return loose_; }
    //! Puts the loose parts' vertices of x (#V) where the targets take them; `rest` #V.
    void place(const std::vector<HoldTarget>& targets, const Eigen::VectorXcd& rest, Eigen::VectorXcd& x) const;

private:
    struct Part {
        std::vector<int> vertices;
        std::vector<double> weights;  // of each hold
    };
    std::vector<bool> loose_;
    std::vector<Part> parts_;
    std::vector<std::complex<double>> anchors_;  // of each hold, at rest
};

}  // namespace puppetwarp
