#include <puppetwarp/deform/dual_complex.h>

#include <puppetwarp/deform/similarity_mean.h>

#include <algorithm>
#include <cmath>

namespace puppetwarp {

namespace {

using Complex = std::complex<double>;

// p, and t conj(p), which is 2 q.
struct DualComplex {
    double p_re, p_im, q_re, q_im;
};

bool scales(const SplitMotion& motion) {
    return motion.log.real() != 0;
}

Eigen::VectorXcd blend_scales(const WeightRows& W, const Eigen::VectorXcd& z, const std::vector<SplitMotion>& motions) {
    std::vector<Similarity> parts;
    parts.reserve(motions.size());
    for (const SplitMotion& each : motions) {
        parts.push_back({each.log.real(), -std::expm1(each.log.real()) * each.centre});
    }
    return similarity_mean(W, z, parts).x;
}

// The motion without its scale, which leaves the centre where it goes.
DualComplex rigid_part(const SplitMotion& motion) {
    const Complex p = std::polar(1.0, motion.log.imag() / 2);
    Complex shift = motion.shift;
    if (scales(motion)) shift += std::expm1(motion.log.real()) * (p * p * motion.centre);
    const Complex q = shift * std::conj(p);
    return {p.real(), p.imag(), q.real(), q.imag()};
}

}  // namespace

BlendedPositions dual_complex_blend(const WeightRows& W, const Eigen::VectorXcd& z,
                                    const std::vector<SplitMotion>& motions) {
    BlendedPositions result{blend_shears(W, z, motions), {}};
    if (std::any_of(motions.begin(), motions.end(), scales)) result.x = blend_scales(W, result.x, motions);
    std::vector<DualComplex> columns;
    columns.reserve(motions.size());
    for (const SplitMotion& each : motions) columns.push_back(rigid_part(each));
    for (Eigen::Index v = 0; v < z.size(); ++v) {
        DualComplex sum{0, 0, 0, 0};
        for (WeightRows::InnerIterator w(W, v); w; ++w) {
            const DualComplex& each = columns[static_cast<std::size_t>(w.col())];
            sum.p_re += w.value() * each.p_re;
            sum.p_im += w.value() * each.p_im;
            sum.q_re += w.value() * each.q_re;
            sum.q_im += w.value() * each.q_im;
        }
        // P (P z + 2 Q) / |P|^2
        double norm = sum.p_re * sum.p_re + sum.p_im * sum.p_im;
        result.unsteady.look_at(v, std::sqrt(norm));
        if (norm == 0) norm = 1;  // no direction: anything finite
        const double re = result.x(v).real(), im = result.x(v).imag();
        const double a = sum.p_re * re - sum.p_im * im + sum.q_re, b = sum.p_re * im + sum.p_im * re + sum.q_im;
        result.x(v) = {(sum.p_re * a - sum.p_im * b) / norm, (sum.p_re * b + sum.p_im * a) / norm};
    }
    return result;
}

}  // namespace puppetwarp
