#include "reference/local_global.h"
#include "reference/test_meshes.h"

#include <puppetwarp/base/errors.h>
#include <puppetwarp/deform/local_global.h>

#include <gtest/gtest.h>

namespace puppetwarp {
namespace {

namespace places = reference::figure_places;

class LocalGlobalTest : public testing::TestWithParam<ArapEnergy> {};

TEST_P(LocalGlobalTest, IsTheAlternationOfThePaperStepByStep) {
    const TriangleMesh mesh = reference::blob(300, 24, 4);
    const std::vector<int> held{0, 1, 2, static_cast<int>(mesh.V.rows()) - 1, static_cast<int>(mesh.V.rows()) / 2};
    const Rig rig = reference::rig_of_vertices(held);
    Pose pose;
    Eigen::MatrixX2d start = mesh.V;
    for (std::size_t k = 3; k < held.size(); ++k) {
        start.row(held[k]) += Eigen::RowVector2d(40, -25.0 * static_cast<double>(k));
        pose.handles[reference::vertex_id(k)].to = start.row(held[k]).transpose();
    }
    const ArapLocalGlobal alternation(mesh, rig, GetParam());
    Eigen::MatrixX2d V = start;
    for (const int steps : {1, 2, 10, 300}) {
        V = start;
        double energy = 0;
        for (int i = 0; i < steps; ++i) energy = alternation.step(pose, V);
        const Eigen::MatrixX2d expected = reference::local_global(mesh, GetParam(), held, start, 0, steps);
        EXPECT_LT((V - expected).cwiseAbs().maxCoeff(), 1e-8);
        EXPECT_NEAR(energy, reference::arap_energy(mesh, GetParam(), expected), 1e-9 * energy);
        EXPECT_EQ(energy, alternation.energy(V));
    }
}

TEST_P(LocalGlobalTest, EnergyNeverRises) {
    const double size = 400;
    const TriangleMesh mesh = reference::figure(size, 14);
    Rig rig = reference::rig_of_points({size * places::head, size * places::left_hand, size * places::right_foot});
    rig.handles.push_back({"spine", BoneHandle{size * Point(0.5, 0.35), size * Point(0.5, 0.6), {}}});
    Pose pose;
    pose.handles["p1"].to = size * (places::left_hand + Point(0.3, 0.2));
    pose.handles["p0"].rotate_rad = 0.8;
    pose.handles["p2"].rotate_rad = -0.5;
    pose.handles["p2"].scale = 1.5;
    pose.handles["spine"].rotate_rad = 0.3;
    const ArapLocalGlobal alternation(mesh, rig, GetParam());
    Eigen::MatrixX2d V = mesh.V;
    double last = alternation.step(pose, V);
    const double first = last;
    for (int i = 0; i < 200; ++i) {
        const double energy = alternation.step(pose, V);
        EXPECT_LE(energy, last * (1 + 1e-12));
        last = energy;
    }
    EXPECT_LT(last, 0.8 * first);
}

// Its fixed point is where `arap`, a different solver, ends.
TEST_P(LocalGlobalTest, EndsWhereTheMethodEnds) {
    const double size = 400;
    const TriangleMesh mesh = reference::figure(size, 18);
    const Rig rig = reference::rig_of_points({size * places::head, size * places::left_hand, size * places::left_foot});
    Pose pose;
    pose.handles["p1"].to = size * (places::left_hand + Point(0.05, 0.04));
    MethodOptions options;
    options.arap_energy = GetParam();
    options.tolerance = 1e-12;
    Progress progress;
    const Deformation minimum = make_deformer(options, mesh, rig)->deform(pose, nullptr, progress);
    const ArapLocalGlobal alternation(mesh, rig, GetParam());
    Eigen::MatrixX2d V = minimum.V;
    EXPECT_NEAR(alternation.step(pose, V), minimum.energy, 1e-9 * minimum.energy);
    EXPECT_LT((V - minimum.V).cwiseAbs().maxCoeff(), 1e-3);
}

INSTANTIATE_TEST_SUITE_P(Energies, LocalGlobalTest,
                         testing::Values(ArapEnergy::elements, ArapEnergy::spokes, ArapEnergy::spokes_and_rims));

TEST(ArapLocalGlobal, RefusesWhatDoesNotFit) {
    const TriangleMesh mesh = reference::grid(4, 4, 10, 10);
    EXPECT_THROW(ArapLocalGlobal(mesh, Rig(), ArapEnergy::elements), InvalidInput);
    const ArapLocalGlobal alternation(mesh, reference::rig_of_points({{5, 5}}), ArapEnergy::elements);
    Eigen::MatrixX2d V = mesh.V.topRows(3);
    EXPECT_THROW(alternation.step(Pose(), V), InvalidInput);
    V = mesh.V;
    EXPECT_LT(alternation.step(Pose(), V), 1e-20);
    EXPECT_LT((V - mesh.V).cwiseAbs().maxCoeff(), 1e-12);
}

}  // namespace
}  // namespace puppetwarp
