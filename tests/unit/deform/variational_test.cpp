// What arap, smooth-arap and fold-free promise beyond what every method does.
#include "reference/local_global.h"
#include "reference/test_meshes.h"

#include <puppetwarp/base/errors.h>
#include <puppetwarp/deform/deformer.h>
#include <puppetwarp/mesh/distortion.h>
#include <puppetwarp/rig/binding.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace puppetwarp {
namespace {

namespace places = reference::figure_places;
constexpr double degree = std::numbers::pi / 180;

MethodOptions options_for(Method method) {
    MethodOptions options;
    options.method = method;
    return options;
}

Deformation deformed(const MethodOptions& options, const TriangleMesh& mesh, const Rig& rig, const Pose& pose) {
    Progress progress;
    return make_deformer(options, mesh, rig)->deform(pose, nullptr, progress);
}

Rig figure_rig(double size) {
    return reference::rig_of_points({size * places::head, size * places::left_hand, size * places::right_hand,
                                     size * places::left_foot, size * places::right_foot, size * places::chest});
}

Polyline square(const Point& centre, double reach) {
    return {centre + Point(-reach, -reach), centre + Point(reach, -reach), centre + Point(reach, reach),
            centre + Point(-reach, reach)};
}

std::string name_of(const testing::TestParamInfo<Method>& each) {
    std::string name = method_name(each.param);
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
}

class VariationalTest : public testing::TestWithParam<Method> {
protected:
    bool springs() const { return GetParam() == Method::fold_free; }
    Deformation deformed_by(const TriangleMesh& mesh, const Rig& rig, const Pose& pose) const {
        return deformed(options_for(GetParam()), mesh, rig, pose);
    }
};

TEST_P(VariationalTest, AnglesAndScalesAreMetAloneAndTogether) {
    const TriangleMesh mesh = reference::figure(600, 9);
    const double disc = default_disc_share * bounding_diagonal(mesh.V);
    const double near = springs() ? 2e-2 : 1e-9;
    for (const double angle : {30.0, -120.0, 175.0}) {
        for (const double scale : {0.7, 1.4}) {
            for (const int fixed : {1, 2, 3}) {
                Pose pose;
                if ((fixed & 1) != 0) pose.handles["p2"].rotate_rad = angle * degree;
                if ((fixed & 2) != 0) pose.handles["p2"].scale = scale;
                const Deformation result = deformed_by(mesh, figure_rig(600), pose);
                EXPECT_TRUE(result.converged);
                const std::complex<double> turn = reference::mean_turn(mesh, result.V, 600 * places::right_hand, disc);
                if ((fixed & 1) != 0) {
                    EXPECT_NEAR(std::arg(turn * std::polar(1.0, -angle * degree)), 0, near) << angle;
                }
                if ((fixed & 2) != 0) {
                    EXPECT_NEAR(std::abs(turn), scale, near) << angle;
                }
                if (springs()) {
                    EXPECT_EQ(measure_distortion(mesh, result.V).flipped_triangles, 0);
                }
            }
        }
    }
}

TEST_P(VariationalTest, RigidMotionsOfHandlesOfEveryKindMoveAllRigidly) {
    const double size = 600;
    const TriangleMesh mesh = reference::figure(size, 14);
    Rig rig = figure_rig(size);
    rig.handles.push_back({"region", RegionHandle{square(size * places::belly, 40), Falloff::none}});
    rig.handles.push_back({"bone", BoneHandle{size * Point(0.2, 0.31), size * Point(0.38, 0.36), ""}});
    const int vertex = reference::nearest_vertex(mesh, size * Point(0.36, 0.88));
    rig.handles.push_back({"vertex", VertexHandle{vertex}});
    for (const double angle : {40.0, -170.0, 250.0, 360.0}) {
        const auto moved = [&](const Point& p) { return reference::rigid(p, {50, 20}, angle * degree, {30, -60}); };
        Pose pose;
        for (const Handle& handle : rig.handles) {
            if (const auto* point = std::get_if<PointHandle>(&handle.shape))
                pose.handles[handle.id].to = moved(point->at);
        }
        pose.handles["p0"].rotate_rad = angle * degree;
        Point centroid(0, 0);
        for (const Point& p : std::get<RegionHandle>(rig.handles[6].shape).points) centroid += p / 4;
        pose.handles["region"].to = moved(centroid);
        pose.handles["region"].rotate_rad = angle * degree;
        pose.handles["bone"].from = moved(size * Point(0.2, 0.31));
        pose.handles["bone"].to = moved(size * Point(0.38, 0.36));
        pose.handles["vertex"].to = moved(mesh.V.row(vertex).transpose());
        const Deformation result = deformed_by(mesh, rig, pose);
        for (int v = 0; v < mesh.V.rows(); ++v) {
            ASSERT_LT((result.V.row(v).transpose() - moved(mesh.V.row(v).transpose())).norm(), 1e-9 * size) << angle;
        }
    }
}

TEST_P(VariationalTest, RegionsTurnFar) {
    const TriangleMesh mesh = reference::grid(30, 30, 300, 300, 0.2, 5);
    Rig rig = reference::rig_of_points({{10, 10}, {290, 10}, {290, 290}, {10, 290}});
    rig.handles.push_back({"region", RegionHandle{square({150, 150}, 40), Falloff::none}});
    Pose pose;
    pose.handles["region"].rotate_rad = 170 * degree;
    const Deformation result = deformed_by(mesh, rig, pose);
    EXPECT_TRUE(result.converged);
    for (int v = 0; v < mesh.V.rows(); ++v) {
        const Point p = mesh.V.row(v).transpose();
        if ((p - Point(150, 150)).cwiseAbs().maxCoeff() > 39.9) continue;
        const Point expected = reference::rigid(p, {150, 150}, 170 * degree, {0, 0});
        ASSERT_LT((result.V.row(v).transpose() - expected).norm(), springs() ? 0.5 : 1e-9);
    }
    if (springs()) {
        EXPECT_EQ(measure_distortion(mesh, result.V).flipped_triangles, 0);
    }
}

TEST_P(VariationalTest, AffineMapsOfPointsAreRefused) {
    const TriangleMesh mesh = reference::grid(6, 6, 60, 60);
    Pose pose;
    pose.handles["p0"].affine = {1, 0, 0.5, 1, 0, 0};
    EXPECT_THROW(deformed_by(mesh, reference::rig_of_points({{30, 30}}), pose), InvalidInput);
}

TEST_P(VariationalTest, StretchAtAPinIsOneAtAnyDensity) {
    if (springs()) return;
    constexpr double size = 1000;
    const Point hand = size * places::right_hand;
    const Point arm = (hand - size * Point(0.88, 0.45)).normalized();
    for (const Point& way : {arm, Point(-arm.y(), arm.x())}) {
        std::vector<double> stretch;
        for (const double edge : {19.5, 8.6}) {
            const TriangleMesh mesh = reference::figure(size, edge);
            const double diagonal = bounding_diagonal(mesh.V);
            Pose pose;
            pose.handles["p2"].to = hand + 0.08 * diagonal * way;
            const Eigen::MatrixX2d V = deformed_by(mesh, figure_rig(size), pose).V;
            // The triangles of the disc alone.
            std::vector<Eigen::RowVector3i> rows;
            for (Eigen::Index t = 0; t < mesh.F.rows(); ++t) {
                const Point centroid =
                    (mesh.V.row(mesh.F(t, 0)) + mesh.V.row(mesh.F(t, 1)) + mesh.V.row(mesh.F(t, 2))).transpose() / 3;
                if ((centroid - hand).norm() < default_disc_share * diagonal) rows.emplace_back(mesh.F.row(t));
            }
            TriangleMesh around{mesh.V, Eigen::MatrixX3i(static_cast<Eigen::Index>(rows.size()), 3)};
            for (std::size_t t = 0; t < rows.size(); ++t) around.F.row(static_cast<Eigen::Index>(t)) = rows[t];
            stretch.push_back(measure_distortion(around, V).max_stretch);
        }
        EXPECT_NEAR(stretch[1] / stretch[0], 1, 0.1);
    }
}

TEST_P(VariationalTest, MeshesOfAnySizeAndOfFewTriangles) {
    for (const double size : {1e-3, 1e7}) {
        const TriangleMesh unit = reference::figure(1, 0.03);
        TriangleMesh mesh = unit;
        mesh.V *= size;
        Pose small, large;
        small.handles["p1"].to = places::left_hand + Point(0.1, 0.2);
        large.handles["p1"].to = size * (places::left_hand + Point(0.1, 0.2));
        const Eigen::MatrixX2d expected = deformed_by(unit, figure_rig(1), small).V;
        EXPECT_LT((deformed_by(mesh, figure_rig(size), large).V / size - expected).cwiseAbs().maxCoeff(), 1e-4);
    }
    TriangleMesh one{Eigen::MatrixX2d(3, 2), Eigen::MatrixX3i(1, 3)};
    one.V << 0, 0, 10, 0, 0, 10;
    one.F << 0, 1, 2;
    for (const TriangleMesh& mesh : {one, reference::grid(1, 1, 10, 10)}) {
        Pose pose;
        pose.handles["p0"].to = Point(5, 1);
        pose.handles["p1"].to = Point(9, 6);
        const Deformation result = deformed_by(mesh, reference::rig_of_points({{1, 1}, {7, 1}}), pose);
        EXPECT_TRUE(result.V.allFinite());
        EXPECT_LE(result.max_handle_error_px, springs() ? 1 : 1e-9);
    }
}

TEST_P(VariationalTest, SliversStayFinite) {
    TriangleMesh mesh = reference::grid(20, 20, 200, 200, 0.2, 3);
    mesh.V.row(5 * 21 + 5) = mesh.V.row(5 * 21 + 6) - Eigen::RowVector2d(1e-4, 0);
    // Whatever the jitter made of its neighbours, nothing is folded.
    if (measure_distortion(mesh, mesh.V).flipped_triangles > 0) GTEST_SKIP();
    Pose pose;
    pose.handles["p1"].to = Point(150, 120);
    const Deformation result = deformed_by(mesh, reference::rig_of_points({{20, 20}, {180, 180}, {20, 180}}), pose);
    EXPECT_TRUE(result.V.allFinite());
    if (springs()) {
        EXPECT_EQ(measure_distortion(mesh, result.V).flipped_triangles, 0);
    }
}

TEST_P(VariationalTest, GreatStiffnessAndPinsSideBySideStayFinite) {
    const TriangleMesh mesh = reference::figure(600, 14);
    Rig rig = figure_rig(600);
    rig.stiffness.push_back(StiffnessRegion{square(600 * places::belly, 60), 1e6});
    rig.handles.push_back({"beside", PointHandle{600 * places::chest + Point(1, 0), {}}});
    Pose pose;
    pose.handles["p5"].to = 600 * places::chest + Point(-3, 5);
    const Deformation result = deformed_by(mesh, rig, pose);
    EXPECT_TRUE(result.V.allFinite());
    if (springs()) {
        EXPECT_EQ(measure_distortion(mesh, result.V).flipped_triangles, 0);
    }
}

// A point whose whole disc a region holds has nothing to move.
TEST_P(VariationalTest, APointInsideARegionFollowsItOrIsRefused) {
    const TriangleMesh mesh = reference::grid(30, 30, 300, 300);
    Rig rig = reference::rig_of_points({{150, 150}, {20, 20}});
    rig.handles.push_back({"region", RegionHandle{square({150, 150}, 60), Falloff::none}});
    Pose together;
    together.handles["p0"].to = Point(170, 140);
    together.handles["region"].to = Point(170, 140);
    EXPECT_TRUE(deformed_by(mesh, rig, together).V.allFinite());
    Pose apart = together;
    apart.handles["p0"].to = Point(100, 100);
    EXPECT_THROW(deformed_by(mesh, rig, apart), InvalidInput);
}

INSTANTIATE_TEST_SUITE_P(Methods, VariationalTest,
                         testing::Values(Method::arap, Method::smooth_arap, Method::fold_free), name_of);

TEST(ConvergedArap, HasNoMoreEnergyThanLocalGlobal) {
    const TriangleMesh bar = reference::grid(14, 5, 140, 50, 0.25, 8), ring = reference::annulus(4, 20, 40, 80);
    for (const TriangleMesh& mesh : {bar, ring}) {
        const Point low = mesh.V.colwise().minCoeff().transpose(), high = mesh.V.colwise().maxCoeff().transpose();
        const std::vector<int> held{reference::nearest_vertex(mesh, low), reference::nearest_vertex(mesh, high),
                                    reference::nearest_vertex(mesh, {high.x(), low.y()})};
        for (const ArapEnergy energy : {ArapEnergy::elements, ArapEnergy::spokes, ArapEnergy::spokes_and_rims}) {
            MethodOptions options;
            options.arap_energy = energy;
            options.tolerance = 1e-13;
            Pose pose;
            Eigen::MatrixX2d start = mesh.V;
            const Point to = mesh.V.row(held[1]).transpose() + Point(-15, 20);
            pose.handles[reference::vertex_id(1)].to = to;
            start.row(held[1]) = to.transpose();
            const Deformation result = deformed(options, mesh, reference::rig_of_vertices(held), pose);
            const Eigen::MatrixX2d slow = reference::local_global(mesh, energy, held, start, 1e-11, 20000);
            const double least = reference::arap_energy(mesh, energy, slow);
            EXPECT_LE(reference::arap_energy(mesh, energy, result.V), least * (1 + 1e-12));
        }
    }
}

}  // namespace
}  // namespace puppetwarp
