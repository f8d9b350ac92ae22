#include <puppetwarp/deform/loose_components.h>

#include <algorithm>

namespace puppetwarp {

namespace {

using Complex = std::complex<double>;

// Keeps a weight finite where a part's centroid is a handle's place, as a ring's around it.
constexpr double nearest_share = 1e-6;

}  // namespace

LooseComponents::LooseComponents(const TriangleMesh& mesh, const std::vector<Hold>& holds)
    : loose_(static_cast<std::size_t>(mesh.V.rows())) {
    const Eigen::VectorXi component = vertex_components(mesh);
    const int count = component.maxCoeff() + 1;
    std::vector<bool> held(static_cast<std::size_t>(count));
    for (const Hold& hold : holds) {
        held[static_cast<std::size_t>(hold.component)] = true;
        anchors_.push_back(hold.at);
    }
    std::vector<int> part_of(static_cast<std::size_t>(count), -1);
    for (int v = 0; v < component.size(); ++v) {
        const auto c = static_cast<std::size_t>(component(v));
        if (held[c]) continue;
        loose_[static_cast<std::size_t>(v)] = true;
        if (part_of[c] < 0) {
            part_of[c] = static_cast<int>(parts_.size());
            parts_.emplace_back();
        }
        parts_[static_cast<std::size_t>(part_of[c])].vertices.push_back(v);
    }
    const double nearest = nearest_share * bounding_diagonal(mesh.V);
    for (Part& part : parts_) {
        Point centroid = Point::Zero();
        for (const int v : part.vertices) centroid += mesh.V.row(v).transpose();
        centroid /= static_cast<double>(part.vertices.size());
        double sum = 0;
        for (const Complex& anchor : anchors_) {
            const double d = std::max(std::abs(anchor - Complex(centroid.x(), centroid.y())), nearest);
            part.weights.push_back(nearest * nearest / (d * d));
            sum += part.weights.back();
        }
        for (double& weight : part.weights) weight /= sum;
    }
}

void LooseComponents::place(const std::vector<HoldTarget>& targets, const Eigen::VectorXcd& rest,
                            Eigen::VectorXcd& x) const {
    for (const Part& part : parts_) {
        Complex centre = 0, move = 0;
        for (std::size_t h = 0; h < anchors_.size(); ++h) {
            centre += part.weights[h] * anchors_[h];
            move += part.weights[h] * targets[h].move;
        }
        // Closest rotation from the anchors around their centre to where they go.
        Complex correlation = 0;
        for (std::size_t h = 0; h < anchors_.size(); ++h) {
            const Complex arm = anchors_[h] - centre;
            correlation += part.weights[h] * std::conj(arm) * (arm + (targets[h].move - move));
        }
        const double length = std::abs(correlation);
        const Complex turn = length > 0 ? correlation / length : Complex(1);
        for (const int v : part.vertices) x(v) = centre + move + turn * (rest(v) - centre);
    }
}

}  // namespace puppetwarp
