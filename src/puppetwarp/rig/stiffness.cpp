#include <puppetwarp/rig/binding.h>
#include <puppetwarp/rig/region.h>

#include <puppetwarp/base/errors.h>

#include <algorithm>
#include <cmath>

namespace puppetwarp {

namespace {

// Bilinear between the centres of the pixels; beyond the outer ones, these.
double grey_at(const StiffnessPicture& picture, const Point& p) {
    const cv::Mat& grey = picture.grey;
    const double x = std::clamp(p.x() * grey.cols / picture.width_px - 0.5, 0.0, grey.cols - 1.0);
    const double y = std::clamp(p.y() * grey.rows / picture.height_px - 0.5, 0.0, grey.rows - 1.0);
    const int i = static_cast<int>(x), j = static_cast<int>(y);
    const double s = x - i, t = y - j;
    const int right = std::min(i + 1, grey.cols - 1);
    const auto* upper = grey.ptr<float>(j);
    const auto* lower = grey.ptr<float>(std::min(j + 1, grey.rows - 1));
    return (1 - t) * ((1 - s) * upper[i] + s * upper[right]) + t * ((1 - s) * lower[i] + s * lower[right]);
}

struct FactorAt {
    const Point& p;

    double operator()(const StiffnessRegion& region) const { return inside(region.points, p) ? region.value : 1; }
    double operator()(const StiffnessPicture& picture) const { return 1 + (picture.max - 1) * grey_at(picture, p); }
};

void require_loaded(const Stiffness& stiffness) {
    const auto* picture = std::get_if<StiffnessPicture>(&stiffness);
    if (picture == nullptr) return;
    if (picture->grey.type() != CV_32FC1 || picture->grey.empty() || !(picture->width_px > 0) ||
        !(picture->height_px > 0)) {
        throw InvalidInput("stiffness picture '" + picture->path + "'", "it is not loaded");
    }
}

}  // namespace

Eigen::VectorXd triangle_stiffness(const TriangleMesh& mesh, const std::vector<Stiffness>& stiffness) {
    if (stiffness.empty()) return {};
    for (const Stiffness& each : stiffness) require_loaded(each);
    Eigen::VectorXd factors = Eigen::VectorXd::Ones(mesh.F.rows());
    for (Eigen::Index t = 0; t < mesh.F.rows(); ++t) {
        const Point centroid = (mesh.V.row(mesh.F(t, 0)) + mesh.V.row(mesh.F(t, 1)) + mesh.V.row(mesh.F(t, 2))) / 3;
        for (const Stiffness& each : stiffness) factors(t) *= std::visit(FactorAt{centroid}, each);
    }
    return factors;
}

}  // namespace puppetwarp
