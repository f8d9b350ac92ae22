#include <puppetwarp/solve/box_qp.h>
#include <puppetwarp/solve/simplex_qp.h>

#include <gtest/gtest.h>
#include <Eigen/Dense>

namespace puppetwarp {
namespace {

// A mesh's small triangles beside large ones make rows of Q with entries far above their own diagonal. Here the first
// unknown would like to be a little below 0, by less than is told from round-off at first; cut off, it pulls the second
// by a thousand times that.
constexpr double below = 5e-10;
constexpr double pull = 500;

TEST(BoxQp, SmallSignsCountWhereClippingThemWouldLeaveMoreThanTheTolerance) {
    Eigen::Matrix2d dense;
    dense << 1e6, pull, pull, 1;
    const Eigen::SparseMatrix<double> Q = dense.sparseView();
    const Eigen::VectorXd c = -dense * Eigen::Vector2d(-below, 0.3);
    const Eigen::VectorXd lower = Eigen::Vector2d::Zero(), upper = Eigen::Vector2d::Ones();
    ASSERT_GT(pull * below, 1e-8);
    const auto found = solve_box_qp({Q, c, lower, upper}, Eigen::Vector2d(0.5, 0.5), {});
    ASSERT_TRUE(found.has_value());
    EXPECT_TRUE(found->converged);
    EXPECT_FALSE(found->safeguarded);
    EXPECT_LE(found->kkt_residual, 1e-8);
    EXPECT_EQ(found->x(0), 0);
    EXPECT_NEAR(found->x(1), -c(1), 1e-12);  // the minimum over the second, the first at 0
}

TEST(SimplexQp, SmallSignsCountWhereClippingThemWouldLeaveMoreThanTheTolerance) {
    // Two columns, so one unknown w a row; a given row, whose share of the first column is 0, moves the minimum there.
    // Both columns pull: Q_ff w = 1/2 (Q_ff 1 + q), q the entries of the given row.
    Eigen::Matrix2d free;
    free << 1e6, pull, pull, 1;
    const Eigen::Vector2d q = free * (2 * Eigen::Vector2d(-below, 0.3) - Eigen::Vector2d::Ones());
    Eigen::Matrix3d dense = Eigen::Matrix3d::Constant(0);
    dense.topLeftCorner<2, 2>() = free;
    dense.topRightCorner<2, 1>() = q;
    dense.bottomLeftCorner<1, 2>() = q.transpose();
    dense(2, 2) = 1e7;
    const Eigen::SparseMatrix<double> Q = dense.sparseView();
    Shares start(3, 2);
    start << 0.5, 0.5, 0.5, 0.5, 0, 1;
    const auto found = solve_simplex_qp({Q, {0, 0, 1}}, start, {});
    ASSERT_TRUE(found.has_value());
    EXPECT_TRUE(found->converged);
    EXPECT_FALSE(found->safeguarded);
    EXPECT_LE(found->kkt_residual, 1e-8);
    EXPECT_EQ(found->W(0, 0), 0);
    EXPECT_NEAR(found->W(1, 0), (pull + 1 + q(1)) / 2, 1e-12);
    EXPECT_NEAR(found->W(1, 0) + found->W(1, 1), 1, 1e-15);
}

}  // namespace
}  // namespace puppetwarp
