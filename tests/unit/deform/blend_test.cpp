// Means of motions against other ways to the same: dual quaternions of space, the iterated Karcher mean.
#include <puppetwarp/deform/dual_complex.h>
#include <puppetwarp/deform/linear_blend.h>
#include <puppetwarp/deform/similarity_mean.h>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <cmath>
#include <numbers>
#include <random>

namespace puppetwarp {
namespace {

using Complex = std::complex<double>;
constexpr double pi = std::numbers::pi;

class Random {
public:
    explicit Random(std::uint32_t seed) : engine_(seed) {}
    double between(double low, double high) { return low + (high - low) * (engine_() / 4294967296.0); }
    Complex place() {
        const double re = between(-1, 1);
        return {re, between(-1, 1)};
    }

private:
    std::mt19937 engine_;
};

Eigen::MatrixXd random_weights(int vertices, int columns, Random& random) {
    Eigen::MatrixXd W(vertices, columns);
    for (double& w : W.reshaped()) w = std::max(0.0, random.between(-0.3, 1));
    for (int v = 0; v < vertices; ++v) {
        W(v, v % columns) += 0.1;
        W.row(v) /= W.row(v).sum();
    }
    return W;
}

Eigen::VectorXcd random_places(int count, Random& random) {
    Eigen::VectorXcd z(count);
    for (Complex& each : z) each = random.place();
    return z;
}

SplitMotion rigid(double angle_rad, const Complex& shift) {
    return {0, Complex(0, angle_rad), shift, 0};
}

std::vector<SplitMotion> random_rigid(int count, double widest_rad, Random& random) {
    std::vector<SplitMotion> motions;
    for (int j = 0; j < count; ++j) {
        const double angle = random.between(-widest_rad, widest_rad);
        motions.push_back(rigid(angle, random.place()));
    }
    return motions;
}

// after(before(z))
Similarity composed(const Similarity& after, const Similarity& before) {
    return {after.log + before.log, std::exp(after.log) * before.shift + after.shift};
}

SplitMotion composed(const SplitMotion& after, const SplitMotion& before) {
    const Similarity both = composed(Similarity{after.log, after.shift}, Similarity{before.log, before.shift});
    return {0, both.log, both.shift, 0};
}

Eigen::VectorXcd applied(const Complex& log, const Complex& shift, const Eigen::VectorXcd& z) {
    return (std::exp(log) * z.array() + shift).matrix();
}

double difference(const Eigen::VectorXcd& a, const Eigen::VectorXcd& b) {
    return (a - b).cwiseAbs().maxCoeff();
}

// The formulas of Kavan et al. 2008 with quaternions about the axis that stands on the plane.
Complex dual_quaternion_blend(const Eigen::RowVectorXd& w, const Complex& z, const std::vector<SplitMotion>& motions) {
    Eigen::Quaterniond real(0, 0, 0, 0), dual(0, 0, 0, 0);
    for (std::size_t j = 0; j < motions.size(); ++j) {
        const double half = motions[j].log.imag() / 2;
        const Eigen::Quaterniond turn(std::cos(half), 0, 0, std::sin(half));
        const Eigen::Quaterniond shift(0, motions[j].shift.real(), motions[j].shift.imag(), 0);
        real.coeffs() += w(static_cast<Eigen::Index>(j)) * turn.coeffs();
        dual.coeffs() += w(static_cast<Eigen::Index>(j)) * 0.5 * (shift * turn).coeffs();
    }
    const double norm = real.norm();
    real.coeffs() /= norm;
    dual.coeffs() /= norm;
    const Eigen::Vector3d moved = real * Eigen::Vector3d(z.real(), z.imag(), 0) + 2 * (dual * real.conjugate()).vec();
    return {moved.x(), moved.y()};
}

TEST(DualComplex, IsTheBlendOfDualQuaternionsInThePlane) {
    Random random(1);
    const Eigen::MatrixXd W = random_weights(300, 5, random);
    const Eigen::VectorXcd z = random_places(300, random);
    const std::vector<SplitMotion> motions = random_rigid(5, 2.6, random);
    const BlendedPositions blended = dual_complex_blend(W.sparseView(), z, motions);
    for (int v = 0; v < z.size(); ++v) {
        EXPECT_LT(std::abs(blended.x(v) - dual_quaternion_blend(W.row(v), z(v), motions)), 1e-12);
    }
}

TEST(DualComplex, IsLeftAndRightInvariant) {
    for (const std::uint32_t seed : {1u, 2u, 3u}) {
        Random random(seed);
        const WeightRows W = random_weights(200, 6, random).sparseView();
        const Eigen::VectorXcd z = random_places(200, random);
        const std::vector<SplitMotion> motions = random_rigid(6, 2.6, random);
        const SplitMotion other = rigid(random.between(-9, 9), random.place());
        std::vector<SplitMotion> after, before;
        for (const SplitMotion& motion : motions) {
            after.push_back(composed(other, motion));
            before.push_back(composed(motion, other));
        }
        const Eigen::VectorXcd x = dual_complex_blend(W, z, motions).x;
        EXPECT_LT(difference(dual_complex_blend(W, z, after).x, applied(other.log, other.shift, x)), 1e-12);
        const Eigen::VectorXcd moved = applied(other.log, other.shift, z);
        EXPECT_LT(difference(dual_complex_blend(W, z, before).x, dual_complex_blend(W, moved, motions).x), 1e-12);
    }
}

// (e^l - 1) / l: what exp makes of a velocity.
Complex exp_factor(const Complex& l) {
    if (std::abs(l) > 0.5) return (std::exp(l) - 1.0) / l;
    Complex sum = 1, term = 1;
    for (int k = 2; k < 25; ++k) sum += term *= l / static_cast<double>(k);
    return sum;
}

// Buss & Fillmore 2001 in the group of similarities: m <- m exp(sum of w_j log(m^-1 T_j)) until it rests.
Similarity iterated_karcher_mean(const Eigen::RowVectorXd& w, const std::vector<Similarity>& motions) {
    Similarity mean = motions[0];
    for (int iteration = 0; iteration < 100; ++iteration) {
        const Similarity inverse{-mean.log, -std::exp(-mean.log) * mean.shift};
        Complex turn = 0, velocity = 0;
        for (std::size_t j = 0; j < motions.size(); ++j) {
            const Similarity seen = composed(inverse, motions[j]);
            turn += w(static_cast<Eigen::Index>(j)) * seen.log;
            velocity += w(static_cast<Eigen::Index>(j)) * seen.shift / exp_factor(seen.log);
        }
        mean = composed(mean, {turn, exp_factor(turn) * velocity});
        if (std::abs(turn) + std::abs(velocity) < 1e-15) break;
    }
    return mean;
}

std::vector<Similarity> random_similarities(int count, double widest_log, double widest_rad, Random& random) {
    std::vector<Similarity> motions;
    for (int j = 0; j < count; ++j) {
        const double log = widest_log > 0 ? random.between(-widest_log, widest_log) : 0;
        const double angle = widest_rad > 0 ? random.between(-widest_rad, widest_rad) : 0;
        motions.push_back({Complex(log, angle), random.place()});
    }
    return motions;
}

TEST(SimilarityMean, IsTheKarcherMeanOfRigidMotions) {
    for (const double widest : {1e-9, 1e-3, 0.03, 0.3, 1.5, 2.5}) {
        Random random(7);
        const Eigen::MatrixXd W = random_weights(200, 5, random);
        const Eigen::VectorXcd z = random_places(200, random);
        const std::vector<Similarity> motions = random_similarities(5, 0, widest, random);
        const BlendedPositions blended = similarity_mean(W.sparseView(), z, motions);
        EXPECT_EQ(blended.unsteady.count, 0);
        for (int v = 0; v < z.size(); ++v) {
            const Similarity mean = iterated_karcher_mean(W.row(v), motions);
            EXPECT_LT(std::abs(blended.x(v) - (std::exp(mean.log) * z(v) + mean.shift)), 1e-12) << widest;
        }
    }
}

TEST(SimilarityMean, IsTheKarcherMeanOfSimilarities) {
    for (const double widest : {1e-9, 1e-3, 0.03, 0.3, 1.5}) {
        Random random(8);
        const Eigen::MatrixXd W = random_weights(200, 5, random);
        const Eigen::VectorXcd z = random_places(200, random);
        const std::vector<Similarity> motions = random_similarities(5, widest / 2, widest, random);
        const BlendedPositions blended = similarity_mean(W.sparseView(), z, motions);
        for (int v = 0; v < z.size(); ++v) {
            const Similarity mean = iterated_karcher_mean(W.row(v), motions);
            EXPECT_LT(std::abs(blended.x(v) - (std::exp(mean.log) * z(v) + mean.shift)), 1e-12) << widest;
        }
    }
}

TEST(SimilarityMean, IsLeftAndRightInvariant) {
    for (const double widest_log : {0.0, 0.7}) {
        Random random(9);
        const WeightRows W = random_weights(200, 6, random).sparseView();
        const Eigen::VectorXcd z = random_places(200, random);
        const std::vector<Similarity> motions = random_similarities(6, widest_log, 2, random);
        const Similarity other{Complex(0.4, 5.1), random.place()};
        std::vector<Similarity> after, before;
        for (const Similarity& motion : motions) {
            after.push_back(composed(other, motion));
            before.push_back(composed(motion, other));
        }
        const Eigen::VectorXcd x = similarity_mean(W, z, motions).x;
        EXPECT_LT(difference(similarity_mean(W, z, after).x, applied(other.log, other.shift, x)), 1e-12);
        const Eigen::VectorXcd moved = applied(other.log, other.shift, z);
        EXPECT_LT(difference(similarity_mean(W, z, before).x, similarity_mean(W, moved, motions).x), 1e-12);
    }
}

// The closed form itself, one vertex at a time in more digits.
Complex mean_slowly(const Eigen::RowVectorXd& w, const Complex& z, const std::vector<Similarity>& motions) {
    using Long = std::complex<long double>;
    const auto g = [](const Long& l) {
        if (std::abs(l) > 0.1L) return l / (std::exp(l) - 1.0L);
        Long sum = 1, term = 1;  // of (e^l - 1) / l
        for (int k = 2; k < 25; ++k) sum += term *= l / static_cast<long double>(k);
        return 1.0L / sum;
    };
    Long log = 0, shift = 0, sum = 0;
    for (std::size_t j = 0; j < motions.size(); ++j) {
        log += static_cast<long double>(w(static_cast<Eigen::Index>(j))) * Long(motions[j].log);
    }
    for (std::size_t j = 0; j < motions.size(); ++j) {
        const Long share = static_cast<long double>(w(static_cast<Eigen::Index>(j))) * g(Long(motions[j].log) - log);
        shift += share * Long(motions[j].shift);
        sum += share;
    }
    const Long x = std::exp(log) * Long(z) + shift / sum;
    return {static_cast<double>(x.real()), static_cast<double>(x.imag())};
}

TEST(SimilarityMean, KeepsItsDigitsForScalesOfAnySize) {
    for (const bool turns : {false, true}) {
        for (const double widest_log : {1e-12, 1e-3, 0.05, 0.4, 0.9, 1.1, 3.0, 9.0}) {
            Random random(10);
            const Eigen::MatrixXd W = random_weights(203, 5, random);
            const Eigen::VectorXcd z = random_places(203, random);
            const std::vector<Similarity> motions = random_similarities(5, widest_log, turns ? 1.5 : 0, random);
            const Eigen::VectorXcd x = similarity_mean(W.sparseView(), z, motions).x;
            for (int v = 0; v < z.size(); ++v) {
                const Complex expected = mean_slowly(W.row(v), z(v), motions);
                EXPECT_LT(std::abs(x(v) - expected), 1e-13 * (1 + std::exp(widest_log))) << widest_log << ' ' << v;
            }
        }
    }
}

// Each vertex comes out to the bit as it does alone, whatever its neighbours are.
TEST(SimilarityMean, DoesNotMixVertices) {
    for (const double widest_rad : {0.0, 1.2}) {
        Random random(11);
        const Eigen::MatrixXd W = random_weights(61, 12, random);
        const Eigen::VectorXcd z = random_places(61, random);
        const std::vector<Similarity> motions = random_similarities(12, 0.8, widest_rad, random);
        const Eigen::VectorXcd x = similarity_mean(W.sparseView(), z, motions).x;
        for (int v = 0; v < z.size(); ++v) {
            const BlendedPositions alone = similarity_mean(W.row(v).sparseView(), z.segment(v, 1), motions);
            EXPECT_EQ(alone.x(0), x(v)) << v;
        }
    }
}

TEST(SimilarityMean, LeavesAVertexWithoutWeights) {
    const Eigen::VectorXcd z = Eigen::VectorXcd::Constant(2, Complex(3, 4));
    Eigen::MatrixXd W(2, 2);
    W << 0, 0, 1, 0;
    for (const double angle : {0.0, 0.5}) {
        const Similarity motion{Complex(0.2, angle), Complex(1, 2)};
        const Eigen::VectorXcd x = similarity_mean(W.sparseView(), z, {motion, motion}).x;
        EXPECT_EQ(x(0), z(0));
        EXPECT_LT(std::abs(x(1) - (std::exp(motion.log) * z(1) + motion.shift)), 1e-14);
    }
}

// One vertex, midway between a column at rest and one that turns about the vertex' far side.
WeightRows halves() {
    return Eigen::MatrixXd::Constant(1, 2, 0.5).sparseView();
}

TEST(LinearBlend, ShrinksAtAJointAndTheOthersDoNot) {
    const Eigen::VectorXcd z = Eigen::VectorXcd::Constant(1, Complex(3, 4));
    for (const auto& [degrees, factor] : {std::pair(90.0, std::sqrt(0.5)), {120.0, 0.5}, {180.0, 0.0}}) {
        const double angle = degrees * pi / 180;
        const std::vector<AffineMap> maps{AffineMap(), {std::polar(1.0, angle), 0, 0}};
        EXPECT_NEAR(std::abs(linear_blend(halves(), z, maps)(0)), 5 * factor, 1e-12);
        const Complex expected = std::polar(1.0, angle / 2) * z(0);
        EXPECT_LT(std::abs(dual_complex_blend(halves(), z, {rigid(0, 0), rigid(angle, 0)}).x(0) - expected), 1e-12);
        EXPECT_LT(std::abs(similarity_mean(halves(), z, {{0, 0}, {Complex(0, angle), 0}}).x(0) - expected), 1e-12);
    }
}

TEST(LinearBlend, IsTheSumOfTheMaps) {
    Random random(4);
    const Eigen::MatrixXd W = random_weights(100, 4, random);
    const Eigen::VectorXcd z = random_places(100, random);
    std::vector<AffineMap> maps;
    for (int j = 0; j < 4; ++j) {
        const Complex alpha = random.place(), beta = random.place();
        maps.push_back({alpha, beta, random.place()});
    }
    const Eigen::VectorXcd x = linear_blend(W.sparseView(), z, maps);
    for (int v = 0; v < 100; ++v) {
        Complex sum = 0;
        for (int j = 0; j < 4; ++j) sum += W(v, j) * maps[static_cast<std::size_t>(j)](z(v));
        EXPECT_LT(std::abs(x(v) - sum), 1e-14);
    }
}

TEST(SimilarityMean, CountsTurnsPastHalfARound) {
    const Eigen::VectorXcd z = Eigen::VectorXcd::Constant(1, 1);
    for (const double degrees : {200.0, 300.0, 350.0}) {
        const double angle = degrees * pi / 180;
        const Complex x = similarity_mean(halves(), z, {{0, 0}, {Complex(0, angle), 0}}).x(0);
        EXPECT_LT(std::abs(x - std::polar(1.0, angle / 2)), 1e-12);
        EXPECT_LT(std::abs(dual_complex_blend(halves(), z, {rigid(0, 0), rigid(angle, 0)}).x(0) - x), 1e-12);
    }
}

TEST(RigidBlends, MeanScalesByTheirLogarithms) {
    const Eigen::VectorXcd z = Eigen::VectorXcd::Constant(1, Complex(2, 1));
    const Complex centre(5, -3);
    const auto scale_about = [&](double scale) {
        return SplitMotion{0, std::log(scale), (1 - scale) * centre, centre};
    };
    const Complex expected = centre + 2.0 * (z(0) - centre);
    EXPECT_LT(std::abs(dual_complex_blend(halves(), z, {scale_about(1), scale_about(4)}).x(0) - expected), 1e-12);
    EXPECT_LT(std::abs(similarity_mean(halves(), z, {{0, 0}, {std::log(4.0), -3.0 * centre}}).x(0) - expected), 1e-12);
}

TEST(RigidBlends, TellWhereMotionsAreAWholeTurnApart) {
    Eigen::MatrixXd W(3, 2);
    W << 1, 0, 0.5, 0.5, 0.1, 0.9;
    const Eigen::VectorXcd z = Eigen::VectorXcd::Constant(3, Complex(2, 1));
    const std::vector<SplitMotion> whole{rigid(0, 0), rigid(2 * pi, Complex(1, 0))};
    for (const BlendedPositions& blended :
         {dual_complex_blend(W.sparseView(), z, whole),
          similarity_mean(W.sparseView(), z, {{whole[0].log, whole[0].shift}, {whole[1].log, whole[1].shift}})}) {
        EXPECT_GE(blended.unsteady.count, 1);
        EXPECT_EQ(blended.unsteady.worst, 1);
        EXPECT_TRUE(blended.x.real().allFinite() && blended.x.imag().allFinite());
    }
    const std::vector<SplitMotion> half{rigid(0, 0), rigid(pi, Complex(1, 0))};
    EXPECT_EQ(dual_complex_blend(W.sparseView(), z, half).unsteady.count, 0);
    EXPECT_EQ(
        similarity_mean(W.sparseView(), z, {{half[0].log, half[0].shift}, {half[1].log, half[1].shift}}).unsteady.count,
        0);
}

}  // namespace
}  // namespace puppetwarp
