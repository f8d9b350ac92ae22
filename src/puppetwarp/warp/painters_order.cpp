#include <puppetwarp/warp/painters_order.h>

#include <puppetwarp/base/errors.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <string>
#include <vector>

namespace puppetwarp {

namespace {

// Corners are added in the order of their depths, so that the sum does not depend on which one the triangle names
// first; divided before, so that large depths do not overflow.
double mean_depth(const Eigen::VectorXd& depth, const Eigen::RowVector3i& face) {
    std::array<double, 3> corners{depth(face[0]) / 3, depth(face[1]) / 3, depth(face[2]) / 3};
    std::sort(corners.begin(), corners.end());
    return corners[0] + corners[1] + corners[2];
}

}  // namespace

Eigen::VectorXi painters_order(const TriangleMesh& mesh, const Eigen::VectorXd& depth) {
    Eigen::VectorXi order(mesh.F.rows());
    std::iota(order.begin(), order.end(), 0);
    if (depth.size() == 0) return order;
    if (depth.size() != mesh.V.rows()) {
        throw InvalidInput("depths", "there are " + std::to_string(depth.size()) + " for a mesh of " +
                                         std::to_string(mesh.V.rows()) + " vertices");
    }
    if (!depth.allFinite()) throw InvalidInput("depths", "not all are finite numbers");
    std::vector<double> depths(static_cast<std::size_t>(mesh.F.rows()));
    for (Eigen::Index f = 0; f < mesh.F.rows(); ++f) {
        depths[static_cast<std::size_t>(f)] = mean_depth(depth, mesh.F.row(f));
    }
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
        return depths[static_cast<std::size_t>(a)] < depths[static_cast<std::size_t>(b)];
    });
    return order;
}

}  // namespace puppetwarp
