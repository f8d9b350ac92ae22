#include <puppetwarp/deform/linear_blend.h>

namespace puppetwarp {

namespace {

// Displacement of a map: turn z + shear conj(z) + shift. In real arithmetic: complex products would check for
// infinities.
struct Displacement {
    double turn_re, turn_im, shear_re, shear_im, shift_re, shift_im;
};

}  // namespace

Eigen::VectorXcd linear_blend(const WeightRows& W, const Eigen::VectorXcd& z, const std::vector<AffineMap>& maps) {
    std::vector<Displacement> displacements;
    displacements.reserve(maps.size());
    for (const AffineMap& map : maps) {
        displacements.push_back({map.alpha.real() - 1, map.alpha.imag(), map.beta.real(), map.beta.imag(),
                                 map.shift.real(), map.shift.imag()});
    }
    Eigen::VectorXcd x(z.size());
    for (Eigen::Index v = 0; v < z.size(); ++v) {
        Displacement sum{0, 0, 0, 0, 0, 0};
        for (WeightRows::InnerIterator w(W, v); w; ++w) {
            const Displacement& each = displacements[static_cast<std::size_t>(w.col())];
            sum.turn_re += w.value() * each.turn_re;
            sum.turn_im += w.value() * each.turn_im;
            sum.shear_re += w.value() * each.shear_re;
            sum.shear_im += w.value() * each.shear_im;
            sum.shift_re += w.value() * each.shift_re;
            sum.shift_im += w.value() * each.shift_im;
        }
        const double re = z(v).real(), im = z(v).imag();
        x(v) = {re + sum.turn_re * re - sum.turn_im * im + sum.shear_re * re + sum.shear_im * im + sum.shift_re,
                im + sum.turn_re * im + sum.turn_im * re - sum.shear_re * im + sum.shear_im * re + sum.shift_im};
    }
    return x;
}

}  // namespace puppetwarp
