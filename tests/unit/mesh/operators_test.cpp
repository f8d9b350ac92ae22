#include "reference/test_meshes.h"

#include <puppetwarp/base/errors.h>
#include <puppetwarp/mesh/distortion.h>
#include <puppetwarp/mesh/operators.h>

#include <gmock/gmock.h>
#include <Eigen/SVD>

#include <cmath>
#include <limits>

namespace puppetwarp {
namespace {

using testing::HasSubstr;

TriangleMesh triangle(Point a, Point b, Point c) {
    TriangleMesh mesh;
    mesh.V.resize(3, 2);
    mesh.V << a.transpose(), b.transpose(), c.transpose();
    mesh.F.resize(1, 3);
    mesh.F << 0, 1, 2;
    return mesh;
}

std::string message_of(const TriangleMesh& mesh) {
    try {
        require_sound(mesh, "mesh.off");
    } catch (const InvalidInput& error) {
        return error.what();
    }
    return "";
}

TEST(CotangentStiffness, OfARightTriangleIsWhatOneComputesByHand) {
    const SparseMatrix L = cotangent_stiffness(triangle({0, 0}, {1, 0}, {0, 1}));
    Eigen::Matrix3d expected;
    expected << 1, -0.5, -0.5, -0.5, 0.5, 0, -0.5, 0, 0.5;
    EXPECT_LT((Eigen::MatrixXd(L) - expected).cwiseAbs().maxCoeff(), 1e-15);
}

TEST(CotangentStiffness, GivesTheDirichletEnergyOfLinearFunctions) {
    const TriangleMesh mesh = reference::grid(7, 5, 3, 2, 0.25);
    const Eigen::VectorXd u = mesh.V * Eigen::Vector2d(2, -3);
    EXPECT_NEAR(u.dot(cotangent_stiffness(mesh) * u), 13 * 6, 1e-10);
    EXPECT_NEAR(u.dot(cotangent_stiffness(mesh, Eigen::VectorXd::Constant(mesh.F.rows(), 5)) * u), 5 * 13 * 6, 1e-9);
}

TEST(CotangentStiffness, RowsSumToZeroAndOrientationDoesNotMatter) {
    TriangleMesh mesh = reference::grid(4, 4, 1, 1, 0.25);
    const SparseMatrix L = cotangent_stiffness(mesh);
    EXPECT_LT((L * Eigen::VectorXd::Ones(L.cols())).cwiseAbs().maxCoeff(), 1e-13);
    mesh.F.col(0).swap(mesh.F.col(1));
    EXPECT_LT((L - cotangent_stiffness(mesh)).norm(), 1e-12);
}

TEST(LumpedMass, IsTheVoronoiAreaOfAcuteAndTheMixedOneOfObtuseTriangles) {
    const Eigen::VectorXd right = lumped_mass(triangle({0, 0}, {1, 0}, {0, 1}));
    EXPECT_NEAR(right(0), 0.25, 1e-15);
    EXPECT_NEAR(right(1), 0.125, 1e-15);
    EXPECT_NEAR(right(2), 0.125, 1e-15);
    const Eigen::VectorXd equilateral = lumped_mass(triangle({0, 0}, {2, 0}, {1, std::sqrt(3.0)}));
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(equilateral(k), std::sqrt(3.0) / 3, 1e-14);
    const Eigen::VectorXd obtuse = lumped_mass(triangle({0, 0}, {4, 0}, {2, 0.5}));
    EXPECT_NEAR(obtuse(2), 0.5, 1e-15);
    EXPECT_NEAR(obtuse(0), 0.25, 1e-15);
}

TEST(LumpedMass, SumsToTheArea) {
    EXPECT_NEAR(lumped_mass(reference::grid(9, 6, 3, 2, 0.25)).sum(), 6, 1e-12);
}

TEST(HatGradients, AreExactForLinearFunctionsInBothOrientations) {
    TriangleMesh mesh = reference::grid(5, 4, 2, 3, 0.25);
    for (int pass = 0; pass < 2; ++pass) {
        const Eigen::MatrixX3cd G = hat_gradients(mesh);
        const Eigen::VectorXd u = mesh.V * Eigen::Vector2d(0.7, -1.9);
        for (Eigen::Index t = 0; t < mesh.F.rows(); ++t) {
            std::complex<double> gradient = 0;
            for (int k = 0; k < 3; ++k) gradient += u(mesh.F(t, k)) * G(t, k);
            EXPECT_LT(std::abs(gradient - std::complex<double>(0.7, -1.9)), 1e-12);
        }
        mesh.F.col(0).swap(mesh.F.col(1));
    }
}

TEST(Distortion, KnowsRotationScaleAndShear) {
    const TriangleMesh mesh = reference::grid(4, 3, 4, 3, 0.2);
    Eigen::Matrix2d J;
    J << std::cos(2.0), -std::sin(2.0), std::sin(2.0), std::cos(2.0);
    Distortion d = measure_distortion(mesh, mesh.V * J.transpose());
    EXPECT_EQ(d.flipped_triangles, 0);
    EXPECT_NEAR(d.max_stretch, 1, 1e-13);
    EXPECT_NEAR(d.max_area_ratio, 1, 1e-13);
    J << 2, 0, 0, 0.25;
    d = measure_distortion(mesh, mesh.V * J.transpose());
    EXPECT_NEAR(d.max_stretch, 2, 1e-13);
    EXPECT_NEAR(d.max_area_ratio, 2, 1e-12);
    J << 1, 1, 0, 1;  // singular values are the golden ratio and its inverse
    EXPECT_NEAR(measure_distortion(mesh, mesh.V * J.transpose()).max_stretch, (1 + std::sqrt(5.0)) / 2, 1e-13);
}

TEST(Distortion, LargestMagnificationPassesOverFoldedTriangles) {
    const TriangleMesh mesh = reference::grid(4, 3, 4, 3, 0.2);
    Eigen::Matrix2d J;
    J << 3, 1, 0, 0.5;
    Eigen::JacobiSVD<Eigen::Matrix2d> svd(J);
    EXPECT_NEAR(largest_magnification(mesh, mesh.V * J.transpose()), svd.singularValues()[0], 1e-12);
    J << 3, 1, 0, -0.5;
    EXPECT_EQ(largest_magnification(mesh, mesh.V * J.transpose()), 0);
}

TEST(Distortion, CountsFlippedAndCollapsedTriangles) {
    const TriangleMesh mesh = triangle({0, 0}, {1, 0}, {0, 1});
    Eigen::MatrixX2d moved = mesh.V;
    moved.row(2) << 0, -1;
    EXPECT_EQ(measure_distortion(mesh, moved).flipped_triangles, 1);
    moved.row(2) << 0.5, 0;
    const Distortion d = measure_distortion(mesh, moved);
    EXPECT_EQ(d.flipped_triangles, 1);
    EXPECT_TRUE(std::isinf(d.max_area_ratio));
}

TEST(VertexComponents, AreNumberedByTheirLowestVertex) {
    TriangleMesh mesh;
    mesh.V = Eigen::MatrixX2d::Random(8, 2);
    mesh.F.resize(2, 3);
    mesh.F << 7, 5, 2, 0, 3, 6;
    Eigen::VectorXi expected(8);
    expected << 0, 1, 2, 0, 3, 2, 0, 2;
    EXPECT_EQ(vertex_components(mesh), expected);
}

TEST(RequireSound, SaysWhatIsWrongWithAMesh) {
    TriangleMesh mesh = reference::grid(2, 2, 1, 1);
    EXPECT_EQ(message_of(mesh), "");
    TriangleMesh clockwise = mesh;
    clockwise.F.col(0).swap(clockwise.F.col(1));
    EXPECT_EQ(message_of(clockwise), "");

    TriangleMesh bad = mesh;
    bad.F(3, 1) = 9;
    EXPECT_THAT(message_of(bad), HasSubstr("triangle 3 names vertex 9"));
    bad = mesh;
    bad.V(4, 1) = std::numeric_limits<double>::quiet_NaN();
    EXPECT_THAT(message_of(bad), HasSubstr("vertex 4"));
    bad = mesh;
    std::swap(bad.F(5, 0), bad.F(5, 1));
    EXPECT_THAT(message_of(bad), HasSubstr("triangle 5 is turned"));
    bad = mesh;
    bad.F(2, 1) = bad.F(2, 0);
    EXPECT_THAT(message_of(bad), HasSubstr("triangle 2 has no area"));
    bad.F.resize(0, 3);
    EXPECT_THAT(message_of(bad), HasSubstr("no triangles"));
}

TEST(RequireSound, DoesNotDependOnTheMeshsSize) {
    for (const double size : {1e-8, 1.0, 1e8}) {
        TriangleMesh mesh = reference::grid(3, 3, 1, 1, 0.2);
        mesh.V *= size;
        EXPECT_EQ(message_of(mesh), "");
    }
}

}  // namespace
}  // namespace puppetwarp
