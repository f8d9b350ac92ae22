#include "reference/local_global.h"
#include "reference/test_meshes.h"

#include <puppetwarp/deform/arap_cells.h>
#include <puppetwarp/deform/element_energy.h>
#include <puppetwarp/deform/smooth_arap_energy.h>
#include <puppetwarp/rig/binding.h>

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>
#include <Eigen/SVD>

#include <cmath>
#include <memory>
#include <random>
#include <string>

namespace puppetwarp {
namespace {

using Complex = std::complex<double>;

constexpr double bending_px = 12;

struct Kind {
    std::string name;
    std::unique_ptr<Energy> (*make)(const TriangleMesh&, const Eigen::VectorXd& stiffness);
    double (*reference)(const TriangleMesh&, const Eigen::MatrixX2d&);
};

void PrintTo(const Kind& kind, std::ostream* out) {
    *out << kind.name;
}

// Laplacian of the positions by edges and cotangents, one vertex at a time.
double bending_reference(const TriangleMesh& mesh, const Eigen::MatrixX2d& x) {
    const SparseMatrix L = cotangent_stiffness(mesh);
    const Eigen::VectorXd mass = lumped_mass(mesh);
    double sum = 0;
    for (int v = 0; v < mesh.V.rows(); ++v) {
        // Triangles all around: the angles at v add up to a full turn.
        double angle = 0;
        for (int t = 0; t < mesh.F.rows(); ++t) {
            for (int k = 0; k < 3; ++k) {
                if (mesh.F(t, k) != v) continue;
                const Eigen::RowVector2d a = mesh.V.row(mesh.F(t, (k + 1) % 3)) - mesh.V.row(v);
                const Eigen::RowVector2d b = mesh.V.row(mesh.F(t, (k + 2) % 3)) - mesh.V.row(v);
                angle += std::acos(a.dot(b) / (a.norm() * b.norm()));
            }
        }
        if (angle < 6.28) continue;
        Eigen::RowVector2d laplacian = Eigen::RowVector2d::Zero();
        for (SparseMatrix::InnerIterator it(L, v); it; ++it) laplacian += it.value() * x.row(it.row());
        sum += laplacian.squaredNorm() / mass(v);
    }
    return bending_px * bending_px * sum;
}

double dirichlet_reference(const TriangleMesh& mesh, const Eigen::MatrixX2d& x) {
    double sum = 0;
    for (int t = 0; t < mesh.F.rows(); ++t) {
        Eigen::Matrix2d rest, now;
        for (int k = 0; k < 2; ++k) {
            rest.col(k) = (mesh.V.row(mesh.F(t, k + 1)) - mesh.V.row(mesh.F(t, 0))).transpose();
            now.col(k) = (x.row(mesh.F(t, k + 1)) - x.row(mesh.F(t, 0))).transpose();
        }
        const Eigen::Matrix2d map = now * rest.inverse();
        sum += std::abs(rest.determinant()) / 2 * (map.squaredNorm() + map.inverse().squaredNorm() - 4);
    }
    return sum;
}

const Kind kinds[] = {
    {"elements", make_element_arap,
     [](const TriangleMesh& mesh, const Eigen::MatrixX2d& x) {
         return reference::arap_energy(mesh, ArapEnergy::elements, x);
     }},
    {"spokes",
     [](const TriangleMesh& mesh, const Eigen::VectorXd& stiffness) -> std::unique_ptr<Energy> {
         return std::make_unique<ArapCells>(mesh, ArapEnergy::spokes, stiffness);
     },
     [](const TriangleMesh& mesh, const Eigen::MatrixX2d& x) {
         return reference::arap_energy(mesh, ArapEnergy::spokes, x);
     }},
    {"spokes_and_rims",
     [](const TriangleMesh& mesh, const Eigen::VectorXd& stiffness) -> std::unique_ptr<Energy> {
         return std::make_unique<ArapCells>(mesh, ArapEnergy::spokes_and_rims, stiffness);
     },
     [](const TriangleMesh& mesh, const Eigen::MatrixX2d& x) {
         return reference::arap_energy(mesh, ArapEnergy::spokes_and_rims, x);
     }},
    {"smooth_arap",
     [](const TriangleMesh& mesh, const Eigen::VectorXd& stiffness) -> std::unique_ptr<Energy> {
         return std::make_unique<SmoothArapEnergy>(mesh, stiffness, bending_px);
     },
     [](const TriangleMesh& mesh, const Eigen::MatrixX2d& x) {
         return reference::arap_energy(mesh, ArapEnergy::elements, x) + bending_reference(mesh, x);
     }},
    {"symmetric_dirichlet", make_symmetric_dirichlet, dirichlet_reference},
};

double uniform(std::mt19937& random) {
    return static_cast<double>(random()) / 2147483648.0 - 1;
}

class EnergyTest : public testing::TestWithParam<Kind> {
protected:
    EnergyTest()
        : mesh_(reference::grid(7, 5, 70, 50, 0.25, 4)),
          energy_(GetParam().make(mesh_, {})),
          x_(complex_positions(mesh_.V)) {
        // Turned, sheared and shaken, but nothing folded over.
        std::mt19937 random(9);
        for (Complex& p : x_) {
            p = std::polar(1.1, 0.4 + 0.01 * p.real()) * p + 0.15 * std::conj(p) +
                Complex(uniform(random), uniform(random));
        }
    }
    Eigen::VectorXcd random_direction(std::uint32_t seed) const {
        std::mt19937 random(seed);
        Eigen::VectorXcd p(x_.size());
        for (Complex& z : p) z = {uniform(random), uniform(random)};
        return p;
    }
    // Second derivative along p, from the constant part and the cells.
    double curvature(const Eigen::VectorXcd& x, const Eigen::VectorXcd& p, HessianKind kind) const {
        double sum = p.dot(energy_->constant_hessian() * p).real();
        for (int c = 0; c < energy_->cells(); ++c) {
            const auto vertices = energy_->vertices(c);
            std::vector<double> lower(vertices.size() * (2 * vertices.size() + 1)), q;
            energy_->cell_hessian(c, x, kind, lower.data());
            for (const int v : vertices) q.insert(q.end(), {p(v).real(), p(v).imag()});
            std::size_t k = 0;
            for (std::size_t i = 0; i < q.size(); ++i) {
                for (std::size_t j = 0; j <= i; ++j, ++k) sum += (i == j ? 1 : 2) * lower[k] * q[i] * q[j];
            }
        }
        return sum;
    }

    TriangleMesh mesh_;
    std::unique_ptr<Energy> energy_;
    Eigen::VectorXcd x_;
};

TEST_P(EnergyTest, IsThatOfThePaper) {
    const double expected = GetParam().reference(mesh_, point_positions(x_));
    EXPECT_GT(expected, 1);
    EXPECT_NEAR(energy_->value(x_), expected, 1e-10 * expected);
}

TEST_P(EnergyTest, VanishesAtRestAndDoesNotFeelRigidMotions) {
    const Eigen::VectorXcd rest = complex_positions(mesh_.V);
    EXPECT_LT(energy_->value(rest), 1e-24);
    const Eigen::VectorXcd moved = (std::polar(1.0, 2.5) * rest).array() + Complex(100, -30);
    EXPECT_LT(energy_->value(moved), 1e-22);
    const Eigen::VectorXcd turned = std::polar(1.0, 2.5) * x_;
    EXPECT_NEAR(energy_->value(turned), energy_->value(x_), 1e-9 * energy_->value(x_));
}

TEST_P(EnergyTest, GradientIsItsSlope) {
    Eigen::VectorXcd gradient;
    EXPECT_NEAR(energy_->gradient(x_, gradient), energy_->value(x_), 1e-12 * energy_->value(x_));
    for (std::uint32_t seed = 1; seed < 4; ++seed) {
        const Eigen::VectorXcd p = random_direction(seed);
        const double h = 1e-5;
        const double slope = (energy_->value(x_ + h * p) - energy_->value(x_ - h * p)) / (2 * h);
        EXPECT_NEAR(gradient.dot(p).real(), slope, 1e-6 * gradient.norm());
    }
}

TEST_P(EnergyTest, HessianIsTheSlopeOfTheGradient) {
    for (std::uint32_t seed = 1; seed < 4; ++seed) {
        const Eigen::VectorXcd p = random_direction(seed);
        const double h = 1e-5;
        Eigen::VectorXcd ahead, behind;
        energy_->gradient(x_ + h * p, ahead);
        energy_->gradient(x_ - h * p, behind);
        const double slope = p.dot(ahead - behind).real() / (2 * h);
        EXPECT_NEAR(curvature(x_, p, HessianKind::exact), slope, 1e-6 * std::abs(slope));
    }
}

TEST_P(EnergyTest, ClampedHessianIsNotNegative) {
    const Eigen::VectorXcd crushed = 0.4 * x_;  // where the true one is indefinite
    bool indefinite = false;
    for (std::uint32_t seed = 1; seed < 40; ++seed) {
        // Turning a few vertices about the middle is what a crushed mesh wants.
        const Eigen::VectorXcd p =
            Complex(0, 1) * (crushed.array() - crushed.mean()).matrix() + 0.1 * random_direction(seed);
        EXPECT_GE(curvature(crushed, p, HessianKind::clamped), 0);
        indefinite = indefinite || curvature(crushed, p, HessianKind::exact) < 0;
    }
    EXPECT_TRUE(indefinite);
}

TEST_P(EnergyTest, StiffnessMultipliesTheFirstOrderPart) {
    const auto stiff = GetParam().make(mesh_, Eigen::VectorXd::Constant(mesh_.F.rows(), 8));
    const double second_order = GetParam().name == "smooth_arap" ? bending_reference(mesh_, point_positions(x_)) : 0;
    const double once = energy_->value(x_) - second_order;
    EXPECT_NEAR(stiff->value(x_) - second_order, 8 * once, 1e-9 * once);
}

INSTANTIATE_TEST_SUITE_P(Energies, EnergyTest, testing::ValuesIn(kinds),
                         [](const auto& kind) { return kind.param.name; });

TEST(SmoothArap, BendingDoesNotFeelAffineMaps) {
    const TriangleMesh mesh = reference::grid(9, 7, 90, 70, 0.25, 2);
    const Eigen::VectorXcd rest = complex_positions(mesh.V);
    const Eigen::VectorXcd sheared = (Complex(1.2, 0.3) * rest + Complex(0.2, -0.1) * rest.conjugate()).eval();
    const double arap = make_element_arap(mesh, {})->value(sheared);
    EXPECT_NEAR(SmoothArapEnergy(mesh, {}, 50).value(sheared), arap, 1e-9 * arap);
}

TEST(SymmetricDirichlet, IsInfiniteWhereATriangleIsFoldedOverOrFlat) {
    const TriangleMesh mesh = reference::grid(3, 3, 30, 30);
    const auto energy = make_symmetric_dirichlet(mesh, {});
    Eigen::VectorXcd x = complex_positions(mesh.V), g;
    x(5) = x(15) + Complex(1, 1);
    EXPECT_EQ(energy->value(x), std::numeric_limits<double>::infinity());
    EXPECT_EQ(energy->gradient(x, g), std::numeric_limits<double>::infinity());
    EXPECT_EQ(energy->value(Eigen::VectorXcd::Zero(mesh.V.rows())), std::numeric_limits<double>::infinity());
}

// The largest step by bisection over the signs of all areas.
TEST(SymmetricDirichlet, LargestStepIsWhereTheFirstTriangleFlattens) {
    const TriangleMesh mesh = reference::grid(6, 6, 60, 60, 0.25, 3);
    const auto energy = make_symmetric_dirichlet(mesh, {});
    const Eigen::VectorXcd x = complex_positions(mesh.V);
    const auto least_area = [&](double t, const Eigen::VectorXcd& step) {
        return double_areas(point_positions(x + t * step), mesh.F).minCoeff();
    };
    for (std::uint32_t seed = 1; seed < 20; ++seed) {
        std::mt19937 random(seed);
        Eigen::VectorXcd step(x.size());
        for (Complex& z : step) z = Complex(uniform(random), uniform(random));
        const double largest = energy->largest_step(x, step);
        ASSERT_LT(largest, 1e6);
        EXPECT_NEAR(least_area(largest, step), 0, 1e-8);
        for (int k = 0; k < 1000; ++k) EXPECT_GT(least_area(largest * k / 1000.0, step), 0);
    }
    EXPECT_EQ(energy->largest_step(x, Eigen::VectorXcd::Ones(x.size())), std::numeric_limits<double>::infinity());
}

}  // namespace
}  // namespace puppetwarp
