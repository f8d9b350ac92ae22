#include "reference/dense_field.h"
#include "reference/test_meshes.h"

#include <puppetwarp/deform/field_responses.h>
#include <puppetwarp/deform/mixed_inverse.h>

#include <gtest/gtest.h>

#include <cmath>

namespace puppetwarp {
namespace {

namespace places = reference::figure_places;

FieldEnergy energy_of(const TriangleMesh& mesh, int order) {
    FieldEnergy energy;
    energy.order = order;
    energy.L = cotangent_stiffness(mesh);
    energy.M = lumped_mass(mesh);
    return energy;
}

std::vector<bool> mask(const TriangleMesh& mesh, const std::function<bool(const Point&)>& inside) {
    std::vector<bool> held;
    for (Eigen::Index v = 0; v < mesh.V.rows(); ++v) held.push_back(inside(mesh.V.row(v).transpose()));
    return held;
}

class FieldInverseTest : public testing::TestWithParam<int> {};

TEST_P(FieldInverseTest, ExtendsWhatIsHeldAsADenseSystemDoes) {
    const TriangleMesh mesh = reference::grid(10, 7, 100, 70, 0.28, 5);
    const auto region = [](const Point& p) { return p.x() < 35 || (p - Point(80, 40)).norm() < 6; };
    const auto border = [](const Point& p) { return p.x() <= 0 || p.x() >= 100 || p.y() <= 0 || p.y() >= 70; };
    for (const auto& held_at : std::vector<std::function<bool(const Point&)>>{region, border}) {
        const std::vector<bool> held = mask(mesh, held_at);
        Eigen::MatrixXd values = Eigen::MatrixXd::Zero(mesh.V.rows(), 2);
        std::vector<reference::DenseConstraint> constraints;
        for (int v = 0; v < mesh.V.rows(); ++v) {
            if (!held[static_cast<std::size_t>(v)]) continue;
            values.row(v) << std::sin(3.1 * v), std::cos(1.7 * v);
            constraints.push_back({{{v, 1.0}}, {values(v, 0), values(v, 1)}});
        }
        const MixedInverse inverse(energy_of(mesh, GetParam()), vertex_components(mesh), held);
        const Eigen::MatrixXd u = inverse.extend(values);
        const Eigen::VectorXcd expected = reference::dense_field(mesh, {GetParam(), 1, 0, {}}, constraints);
        // Values without any smoothness make the fields of high order large.
        const double size = expected.cwiseAbs().maxCoeff();
        EXPECT_LT((u.col(0) - expected.real()).cwiseAbs().maxCoeff(), 1e-12 * size);
        EXPECT_LT((u.col(1) - expected.imag()).cwiseAbs().maxCoeff(), 1e-12 * size);
    }
}

// Two ways to one answer: powers of the inverse, and the mixed system with nothing held.
TEST_P(FieldInverseTest, RespondsAlikeByPowersAndByTheMixedSystem) {
    const TriangleMesh mesh = reference::joined(reference::figure(500, 12), reference::grid(5, 5, 50, 50), {600, 0});
    const std::vector<bool> none(static_cast<std::size_t>(mesh.V.rows()));
    const FieldEnergy energy = energy_of(mesh, GetParam());
    Eigen::MatrixXd loads(mesh.V.rows(), 5);
    for (Eigen::Index v = 0; v < loads.rows(); ++v) {
        for (Eigen::Index c = 0; c < 5; ++c) loads(v, c) = std::sin(0.7 * static_cast<double>((v + 1) * (c + 2)));
    }
    const Eigen::VectorXi component = vertex_components(mesh);
    const Eigen::MatrixXd by_powers = make_field_inverse(energy, component, none)->respond(loads);
    const Eigen::MatrixXd mixed = MixedInverse(energy, component, none).respond(loads);
    for (Eigen::Index c = 0; c < 5; ++c) {
        EXPECT_LT((by_powers.col(c) - mixed.col(c)).norm(), 1e-10 * mixed.col(c).norm());
    }
}

// The assembled matrix is void here: at order 3 it misses by the field's size, at order 4 by ten times that.
TEST_P(FieldInverseTest, ConstantsOnFineMeshesComeOutConstant) {
    const TriangleMesh mesh = reference::figure(1000, 4.3);
    ASSERT_GT(mesh.V.rows(), 20000);
    const Rig rig =
        reference::rig_of_points({1000 * places::head, 1000 * places::left_hand, 1000 * places::right_hand,
                                  1000 * places::left_foot, 1000 * places::right_foot, 1000 * places::chest});
    const std::vector<Hold> holds = take_hold(mesh, rig, "test").holds;
    const std::vector<bool> none(static_cast<std::size_t>(mesh.V.rows()));
    const Eigen::VectorXi component = vertex_components(mesh);
    const FieldResponses responses(make_field_inverse(energy_of(mesh, GetParam()), component, none), component, none,
                                   holds, nullptr);
    std::vector<FieldGoal> goals(holds.size());
    for (FieldGoal& goal : goals) goal.mean = 1;
    Eigen::VectorXcd u = Eigen::VectorXcd::Zero(mesh.V.rows());
    responses.bring_to(goals, u);
    EXPECT_LT((u.array() - 1.0).abs().maxCoeff(), 1e-9);
}

TEST_P(FieldInverseTest, ConstantsFromHeldVerticesOnFineMeshesComeOutConstant) {
    const TriangleMesh mesh = reference::figure(1000, 6);
    const std::vector<bool> held = mask(mesh, [](const Point& p) {
        return (p - Point(500, 550)).norm() < 60 || (p - 1000 * places::left_hand).norm() < 5;
    });
    Eigen::MatrixXd values = Eigen::MatrixXd::Zero(mesh.V.rows(), 1);
    for (Eigen::Index v = 0; v < mesh.V.rows(); ++v) values(v) = held[static_cast<std::size_t>(v)] ? 1 : 0;
    const MixedInverse inverse(energy_of(mesh, GetParam()), vertex_components(mesh), held);
    EXPECT_LT((inverse.extend(values).array() - 1).abs().maxCoeff(), 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Orders, FieldInverseTest, testing::Values(1, 2, 3, 4));

}  // namespace
}  // namespace puppetwarp
