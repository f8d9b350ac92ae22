#include <puppetwarp/deform/element_energy.h>

#include <algorithm>
#include <cmath>

namespace puppetwarp {

namespace {

using Complex = std::complex<double>;

constexpr double infinity = std::numeric_limits<double>::infinity();

// f_z and f_zbar of an element, in real arithmetic: complex products would check for infinities.
struct Map {
    double ar, ai, br, bi;
};

Map map_of(const Element& e, const Eigen::VectorXcd& x) {
    const Complex& x0 = x(e.v[0]);
    const double ur = x(e.v[1]).real() - x0.real(), ui = x(e.v[1]).imag() - x0.imag();
    const double vr = x(e.v[2]).real() - x0.real(), vi = x(e.v[2]).imag() - x0.imag();
    const double p = e.c1.real(), q = e.c1.imag(), r = e.c2.real(), s = e.c2.imag();
    return {p * ur - q * ui + r * vr - s * vi, p * ui + q * ur + r * vi + s * vr, p * ur + q * ui + r * vr + s * vi,
            p * ui - q * ur + r * vi - s * vr};
}

// Adds the derivative of weight * psi, given psi_a / a * f_z and psi_b / b * f_zbar.
void scatter(const Element& e, double gar, double gai, double gbr, double gbi, Eigen::VectorXcd& g) {
    const double p = e.c1.real(), q = e.c1.imag(), r = e.c2.real(), s = e.c2.imag();
    const Complex first(p * gar + q * gai + p * gbr - q * gbi, p * gai - q * gar + p * gbi + q * gbr);
    const Complex second(r * gar + s * gai + r * gbr - s * gbi, r * gai - s * gar + r * gbi + s * gbr);
    g(e.v[1]) += first;
    g(e.v[2]) += second;
    g(e.v[0]) -= first + second;
}

// A direction over (Re, Im) of the three corners: of Re(conj(unit) f), f = sum of c_k x_k.
struct Row {
    double at[6];
};

Row row_of(const Complex& unit, const Complex& c1, const Complex& c2) {
    const Complex u1 = std::conj(unit) * c1, u2 = std::conj(unit) * c2, u0 = -(u1 + u2);
    return {{u0.real(), -u0.imag(), u1.real(), -u1.imag(), u2.real(), -u2.imag()}};
}

Complex direction_of(double re, double im) {
    const double length = std::hypot(re, im);
    return length > 0 ? Complex(re / length, im / length) : Complex(1);
}

class ElementEnergy : public Energy {
public:
    ElementEnergy(const TriangleMesh& mesh, const Eigen::VectorXd& stiffness)
        : elements_(elements_of(mesh, stiffness)) {}

    int cells() const override { return static_cast<int>(elements_.size()); }
    std::span<const int> vertices(int cell) const override { return element(cell).v; }

protected:
    const std::vector<Element>& elements() const { return elements_; }
    const Element& element(int cell) const { return elements_[static_cast<std::size_t>(cell)]; }

private:
    std::vector<Element> elements_;
};

class ElementArap : public ElementEnergy {
public:
    ElementArap(const TriangleMesh& mesh, const Eigen::VectorXd& stiffness)
        : ElementEnergy(mesh, stiffness), twice_stiffness_(2 * cotangent_stiffness(mesh, stiffness)) {}

    const SparseMatrix& constant_hessian() const override { return twice_stiffness_; }

    double value(const Eigen::VectorXcd& x) const override {
        double sum = 0;
        for (const Element& e : elements()) {
            const Map m = map_of(e, x);
            const double a = std::sqrt(m.ar * m.ar + m.ai * m.ai);
            sum += e.weight * 2 * ((a - 1) * (a - 1) + m.br * m.br + m.bi * m.bi);
        }
        return sum;
    }

    double gradient(const Eigen::VectorXcd& x, Eigen::VectorXcd& g) const override {
        g.setZero(x.size());
        double sum = 0;
        for (const Element& e : elements()) {
            const Map m = map_of(e, x);
            const double a = std::sqrt(m.ar * m.ar + m.ai * m.ai);
            sum += e.weight * 2 * ((a - 1) * (a - 1) + m.br * m.br + m.bi * m.bi);
            const double w = 4 * e.weight;
            if (a > 0) {
                const double f = w * (a - 1) / a;
                scatter(e, f * m.ar, f * m.ai, w * m.br, w * m.bi, g);
            } else {
                scatter(e, -w, 0, w * m.br, w * m.bi, g);  // any rotation is closest; 1 it is
            }
        }
        return sum;
    }

    // -(4 weight / a) t t^T, t the derivative of the angle.
    void cell_hessian(int cell, const Eigen::VectorXcd& x, HessianKind kind, double* lower) const override {
        const Element& e = element(cell);
        const Map m = map_of(e, x);
        // There is a cusp where the rotation is undefined; far enough from it the true weight is taken.
        double a = std::max(std::hypot(m.ar, m.ai), 1e-9);
        if (kind == HessianKind::clamped) a = std::max(a, 1.0);
        const Row t = row_of(Complex(0, 1) * direction_of(m.ar, m.ai), e.c1, e.c2);
        const double factor = -4 * e.weight / a;
        for (int i = 0; i < 6; ++i) {
            for (int j = 0; j <= i; ++j) *lower++ = factor * t.at[i] * t.at[j];
        }
    }

private:
    SparseMatrix twice_stiffness_;
};

class SymmetricDirichlet : public ElementEnergy {
public:
    SymmetricDirichlet(const TriangleMesh& mesh, const Eigen::VectorXd& stiffness)
        : ElementEnergy(mesh, stiffness), none_(mesh.V.rows(), mesh.V.rows()) {}

    const SparseMatrix& constant_hessian() const override { return none_; }

    double value(const Eigen::VectorXcd& x) const override {
        double sum = 0;
        for (const Element& e : elements()) {
            const Map m = map_of(e, x);
            const double density = density_of(m.ar * m.ar + m.ai * m.ai, m.br * m.br + m.bi * m.bi);
            if (!(density < infinity)) return infinity;
            sum += e.weight * density;
        }
        return sum;
    }

    double gradient(const Eigen::VectorXcd& x, Eigen::VectorXcd& g) const override {
        g.setZero(x.size());
        double sum = 0;
        for (const Element& e : elements()) {
            const Map m = map_of(e, x);
            const double a2 = m.ar * m.ar + m.ai * m.ai, b2 = m.br * m.br + m.bi * m.bi;
            const double density = density_of(a2, b2);
            if (!(density < infinity)) return infinity;
            sum += e.weight * density;
            const double inverse = 1 / (a2 - b2), square = inverse * inverse;
            const double both = 4 * e.weight * (1 + square), apart = 8 * e.weight * (a2 + b2) * square * inverse;
            const double qt = both - apart, qf = both + apart;
            scatter(e, qt * m.ar, qt * m.ai, qf * m.br, qf * m.bi, g);
        }
        return sum;
    }

    double largest_step(const Eigen::VectorXcd& x, const Eigen::VectorXcd& step) const override {
        double largest = infinity;
        for (const Element& e : elements()) {
            const Map m = map_of(e, x), d = map_of(e, step);
            const double c = m.ar * m.ar + m.ai * m.ai - m.br * m.br - m.bi * m.bi;
            const double b = 2 * (m.ar * d.ar + m.ai * d.ai - m.br * d.br - m.bi * d.bi);
            const double a = d.ar * d.ar + d.ai * d.ai - d.br * d.br - d.bi * d.bi;
            const double discriminant = b * b - 4 * a * c;
            if (discriminant < 0) continue;
            // Both roots without cancellation; c > 0.
            const double q = -0.5 * (b + std::copysign(std::sqrt(discriminant), b));
            if (q / a > 0) largest = std::min(largest, q / a);
            if (c / q > 0) largest = std::min(largest, c / q);
        }
        return largest;
    }

    void cell_hessian(int cell, const Eigen::VectorXcd& x, HessianKind kind, double* lower) const override {
        const Element& e = element(cell);
        const Map m = map_of(e, x);
        const double a = std::hypot(m.ar, m.ai), b = std::hypot(m.br, m.bi);
        const double S = a * a + b * b, D = (a + b) * (a - b);
        const double i2 = 1 / (D * D), i3 = i2 / D, i4 = i2 * i2;
        double qt = 4 * (1 + i2) - 8 * S * i3;
        const double qf = 4 * (1 + i2) + 8 * S * i3;
        const bool conformal = b < 1e-12;  // where the direction of f_zbar has no meaning
        const double aa = qt - 32 * a * a * i3 + 48 * a * a * S * i4;
        const double ab = conformal ? 0 : -48 * a * b * S * i4;
        const double bb = conformal ? qf : qf + 32 * b * b * i3 + 48 * b * b * S * i4;
        // Only the twist can bend downwards.
        if (kind == HessianKind::clamped) qt = std::max(qt, 0.0) + clamped_twist;
        const Complex along_a = direction_of(m.ar, m.ai), along_b = direction_of(m.br, m.bi);
        const Row ra = row_of(along_a, e.c1, e.c2), ta = row_of(Complex(0, 1) * along_a, e.c1, e.c2);
        const Row rb = row_of(along_b, std::conj(e.c1), std::conj(e.c2));
        const Row tb = row_of(Complex(0, 1) * along_b, std::conj(e.c1), std::conj(e.c2));
        for (int i = 0; i < 6; ++i) {
            for (int j = 0; j <= i; ++j) {
                *lower++ = e.weight * (aa * ra.at[i] * ra.at[j] + ab * (ra.at[i] * rb.at[j] + rb.at[i] * ra.at[j]) +
                                       bb * rb.at[i] * rb.at[j] + qt * ta.at[i] * ta.at[j] + qf * tb.at[i] * tb.at[j]);
            }
        }
    }

private:
    // Keeps the clamped Hessian definite in the rotations that the clamp left without stiffness.
    static constexpr double clamped_twist = 0.02 * 4;

    // |D|^2 + |D^-1|^2 - 4 = (s - 1/s)^2 + (t - 1/t)^2 of the singular values: no difference of large numbers near
    // rest. Infinite where the triangle is folded over or has no area.
    static double density_of(double a2, double b2) {
        const double a = std::sqrt(a2), b = std::sqrt(b2);
        const double s = a + b, t = a - b;
        if (!(t > 0)) return infinity;
        const double u = (s - 1) * (s + 1) / s, v = (t - 1) * (t + 1) / t;
        return u * u + v * v;
    }

    SparseMatrix none_;
};

}  // namespace

std::vector<Element> elements_of(const TriangleMesh& mesh, const Eigen::VectorXd& stiffness) {
    const Eigen::MatrixX3cd gradients = hat_gradients(mesh);
    const Eigen::VectorXd areas = double_areas(mesh.V, mesh.F).cwiseAbs() / 2;
    std::vector<Element> elements;
    elements.reserve(static_cast<std::size_t>(mesh.F.rows()));
    for (int t = 0; t < mesh.F.rows(); ++t) {
        elements.push_back({{mesh.F(t, 0), mesh.F(t, 1), mesh.F(t, 2)},
                            areas(t) * (stiffness.size() == 0 ? 1.0 : stiffness(t)),
                            0.5 * std::conj(gradients(t, 1)),
                            0.5 * std::conj(gradients(t, 2))});
    }
    return elements;
}

std::unique_ptr<Energy> make_element_arap(const TriangleMesh& mesh, const Eigen::VectorXd& stiffness) {
    return std::make_unique<ElementArap>(mesh, stiffness);
}

std::unique_ptr<Energy> make_symmetric_dirichlet(const TriangleMesh& mesh, const Eigen::VectorXd& stiffness) {
    return std::make_unique<SymmetricDirichlet>(mesh, stiffness);
}

}  // namespace puppetwarp
