#include <puppetwarp/deform/reference_motion.h>

#include <cmath>
#include <map>
#include <utility>

namespace puppetwarp {

namespace {

using Complex = std::complex<double>;

// What one hold or held vertex says of its component's motion.
struct Sample {
    int component;
    double weight;
    Complex at;
    Complex move;
};

std::vector<Sample> samples_of(const Binding& binding, const Targets& targets, const Eigen::VectorXi& component,
                               const Eigen::VectorXcd& rest) {
    std::vector<Sample> samples;
    for (std::size_t h = 0; h < binding.holds.size(); ++h) {
        const Hold& hold = binding.holds[h];
        samples.push_back({hold.component, 1, row_value(hold.mean, rest), targets.holds[h].move});
    }
    // A region counts as one handle, however many vertices it holds.
    std::map<std::pair<int, int>, int> count;
    for (const HeldVertex& held : binding.vertices) ++count[{held.handle, component(held.vertex)}];
    for (std::size_t k = 0; k < binding.vertices.size(); ++k) {
        const HeldVertex& held = binding.vertices[k];
        const int c = component(held.vertex);
        samples.push_back({c, 1.0 / count[{held.handle, c}], rest(held.vertex),
                           targets.vertices(static_cast<Eigen::Index>(k)) - rest(held.vertex)});
    }
    return samples;
}

}  // namespace

ReferenceMotion::ReferenceMotion(MotionKind kind, const Binding& binding, const Targets& targets,
                                 const Eigen::VectorXi& component, const Eigen::VectorXcd& rest)
    : component_(component), motions_(static_cast<std::size_t>(component.maxCoeff() + 1)) {
    const std::vector<Sample> samples = samples_of(binding, targets, component, rest);
    std::vector<double> weight(motions_.size()), size(motions_.size());
    std::vector<Complex> correlation(motions_.size());
    for (const Sample& s : samples) weight[static_cast<std::size_t>(s.component)] += s.weight;
    for (const Sample& s : samples) {
        const auto c = static_cast<std::size_t>(s.component);
        motions_[c].from += s.weight / weight[c] * s.at;
        motions_[c].move += s.weight / weight[c] * s.move;
    }
    if (kind == MotionKind::translation) return;
    for (const Sample& s : samples) {
        const auto c = static_cast<std::size_t>(s.component);
        const Complex arm = s.at - motions_[c].from;
        correlation[c] += s.weight * std::conj(arm) * (arm + (s.move - motions_[c].move));
        size[c] += s.weight * std::norm(arm);
    }
    for (std::size_t h = 0; h < binding.holds.size(); ++h) {
        if (!targets.holds[h].rotate_rad) continue;
        const auto c = static_cast<std::size_t>(binding.holds[h].component);
        const double share = binding.holds[h].radius_px * binding.holds[h].radius_px;
        correlation[c] += share * std::polar(targets.holds[h].scale.value_or(1), *targets.holds[h].rotate_rad);
        size[c] += share;
    }
    for (std::size_t c = 0; c < motions_.size(); ++c) {
        const double length = std::abs(correlation[c]);
        if (length > 0) motions_[c].turn = correlation[c] / (kind == MotionKind::rigid ? length : size[c]);
    }
}

Eigen::VectorXcd ReferenceMotion::applied(const Eigen::VectorXcd& rest) const {
    Eigen::VectorXcd x(rest.size());
    for (int v = 0; v < component_.size(); ++v) {
        const Motion& motion = motions_[static_cast<std::size_t>(component_(v))];
        // As a displacement, so that what does not turn is moved without round-off.
        x(v) = rest(v) + motion.move + (motion.turn - 1.0) * (rest(v) - motion.from);
    }
    return x;
}

}  // namespace puppetwarp
