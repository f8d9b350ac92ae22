#include "reference/local_global.h"
#include "reference/test_meshes.h"

#include <puppetwarp/deform/arap_energy.h>
#include <puppetwarp/rig/binding.h>

#include <gtest/gtest.h>

#include <random>

namespace puppetwarp {
namespace {

using Complex = std::complex<double>;

constexpr ArapEnergy energies[] = {ArapEnergy::elements, ArapEnergy::spokes, ArapEnergy::spokes_and_rims};

class ArapCellsTest : public testing::TestWithParam<ArapEnergy> {
protected:
    ArapCellsTest()
        : mesh_(reference::grid(7, 5, 70, 50, 0.25, 4)), cells_(mesh_, GetParam(), {}), x_(complex_positions(mesh_.V)) {
        std::mt19937 random(9);
        for (Complex& p : x_) p += Complex(uniform(random), uniform(random)) * 3.0;
    }
    static double uniform(std::mt19937& random) { return static_cast<double>(random()) / 2147483648.0 - 1; }
    Eigen::VectorXcd random_direction(std::uint32_t seed) const {
        std::mt19937 random(seed);
        Eigen::VectorXcd p(x_.size());
        for (Complex& z : p) z = {uniform(random), uniform(random)};
        return p;
    }
    // Second derivative along p, from K and the twists.
    double curvature(const Eigen::VectorXcd& p, bool clamped) const {
        double sum = 2 * p.dot(cells_.K() * p).real();
        std::vector<Complex> room;
        for (int c = 0; c < cells_.count(); ++c) {
            const ArapCells::Twist twist = cells_.twist(c, x_, clamped, room);
            double product = 0;
            for (const int* v = cells_.vertices_begin(c); v != cells_.vertices_end(c); ++v) {
                const Complex t = twist.t[v - cells_.vertices_begin(c)];
                product += t.real() * p(*v).real() + t.imag() * p(*v).imag();
            }
            sum -= twist.weight * product * product;
        }
        return sum;
    }

    TriangleMesh mesh_;
    ArapCells cells_;
    Eigen::VectorXcd x_;
};

TEST_P(ArapCellsTest, EnergyIsThatOfThePaper) {
    const double expected = reference::arap_energy(mesh_, GetParam(), point_positions(x_));
    EXPECT_NEAR(cells_.energy(x_), expected, 1e-10 * expected);
}

TEST_P(ArapCellsTest, EnergyVanishesUnderRigidMotions) {
    const Eigen::VectorXcd rest = complex_positions(mesh_.V);
    EXPECT_EQ(cells_.energy(rest), 0);
    const Eigen::VectorXcd moved = (std::polar(1.0, 2.5) * rest).array() + Complex(100, -30);
    EXPECT_LT(cells_.energy(moved), 1e-22);
    const Eigen::VectorXcd turned = std::polar(1.0, 2.5) * x_;
    EXPECT_NEAR(cells_.energy(turned), cells_.energy(x_), 1e-9 * cells_.energy(x_));
}

TEST_P(ArapCellsTest, GradientIsTheSlopeOfTheEnergy) {
    Eigen::VectorXcd gradient;
    EXPECT_NEAR(cells_.gradient(x_, gradient), cells_.energy(x_), 1e-9);
    for (std::uint32_t seed = 1; seed < 4; ++seed) {
        const Eigen::VectorXcd p = random_direction(seed);
        const double h = 1e-5;
        const double slope = (cells_.energy(x_ + h * p) - cells_.energy(x_ - h * p)) / (2 * h);
        EXPECT_NEAR(gradient.dot(p).real(), slope, 1e-6 * gradient.norm());
    }
}

TEST_P(ArapCellsTest, HessianIsTheSlopeOfTheGradient) {
    for (std::uint32_t seed = 1; seed < 4; ++seed) {
        const Eigen::VectorXcd p = random_direction(seed);
        const double h = 1e-5;
        Eigen::VectorXcd ahead, behind;
        cells_.gradient(x_ + h * p, ahead);
        cells_.gradient(x_ - h * p, behind);
        const double slope = p.dot(ahead - behind).real() / (2 * h);
        EXPECT_NEAR(curvature(p, false), slope, 1e-6 * std::abs(slope));
    }
}

TEST_P(ArapCellsTest, ClampedHessianIsNotNegativeOnAcuteMeshes) {
    x_ *= 0.4;  // crushed: the true Hessian is indefinite
    bool indefinite = false;
    for (std::uint32_t seed = 1; seed < 40; ++seed) {
        // Turning a few vertices about the middle is what a crushed mesh wants.
        Eigen::VectorXcd p = Complex(0, 1) * (x_.array() - x_.mean()).matrix() + 0.1 * random_direction(seed);
        EXPECT_GE(curvature(p, true), 0);
        indefinite = indefinite || curvature(p, false) < 0;
    }
    EXPECT_TRUE(indefinite);
}

INSTANTIATE_TEST_SUITE_P(Energies, ArapCellsTest, testing::ValuesIn(energies));

TEST(ArapCells, StiffnessMultipliesTheEnergy) {
    const TriangleMesh mesh = reference::grid(5, 5, 10, 10, 0.2);
    Eigen::VectorXcd x = complex_positions(mesh.V);
    for (Eigen::Index v = 0; v < x.size(); ++v) x(v) += Complex(std::sin(3.0 * static_cast<double>(v)), 0);
    for (const ArapEnergy energy : energies) {
        const double once = ArapCells(mesh, energy, {}).energy(x);
        const double eight = ArapCells(mesh, energy, Eigen::VectorXd::Constant(mesh.F.rows(), 8)).energy(x);
        EXPECT_NEAR(eight, 8 * once, 1e-9 * eight);
    }
}

}  // namespace
}  // namespace puppetwarp
