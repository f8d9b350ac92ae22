#include <puppetwarp/solve/ordered_qp.h>

#include <gtest/gtest.h>
#include <Eigen/Dense>

#include <algorithm>
#include <random>

namespace puppetwarp {
namespace {

// A constraint as a row: row * x >= least.
struct Rows {
    Eigen::MatrixXd A;
    Eigen::VectorXd b;
};

Rows rows_of(const std::vector<OrderConstraint>& constraints, Eigen::Index n) {
    const auto count = static_cast<Eigen::Index>(constraints.size());
    Rows rows{Eigen::MatrixXd::Zero(count, n), Eigen::VectorXd(count)};
    for (Eigen::Index i = 0; i < count; ++i) {
        const OrderConstraint& each = constraints[static_cast<std::size_t>(i)];
        if (each.high >= 0) rows.A(i, each.high) = 1;
        if (each.low >= 0) rows.A(i, each.low) = -1;
        rows.b(i) = each.least;
    }
    return rows;
}

// The textbook's primal active set method (Nocedal & Wright, algorithm 16.3), dense. \param x  feasible.
Eigen::VectorXd active_set_minimum(const Eigen::MatrixXd& Q, const Eigen::VectorXd& c, const Rows& rows,
                                   Eigen::VectorXd x) {
    const Eigen::Index n = x.size();
    std::vector<Eigen::Index> active;
    for (int round = 0; round < 20000; ++round) {
        const auto m = static_cast<Eigen::Index>(active.size());
        Eigen::MatrixXd K = Eigen::MatrixXd::Zero(n + m, n + m);
        Eigen::VectorXd r = Eigen::VectorXd::Zero(n + m);
        K.topLeftCorner(n, n) = Q;
        for (Eigen::Index i = 0; i < m; ++i) {
            K.col(n + i).head(n) = rows.A.row(active[static_cast<std::size_t>(i)]).transpose();
            K.row(n + i).head(n) = rows.A.row(active[static_cast<std::size_t>(i)]);
        }
        r.head(n) = -(Q * x + c);
        const Eigen::VectorXd solved = K.partialPivLu().solve(r);
        const Eigen::VectorXd p = solved.head(n);
        if (p.cwiseAbs().maxCoeff() < 1e-12) {
            // Multipliers are those of -A^T: the wrong ones are above 0.
            Eigen::Index worst = -1;
            for (Eigen::Index i = 0; i < m; ++i) {
                if (solved(n + i) > 1e-10 && (worst < 0 || solved(n + i) > solved(n + worst))) worst = i;
            }
            if (worst < 0) return x;
            active.erase(active.begin() + worst);
            continue;
        }
        double length = 1;
        Eigen::Index blocking = -1;
        for (Eigen::Index i = 0; i < rows.b.size(); ++i) {
            if (std::find(active.begin(), active.end(), i) != active.end()) continue;
            const double slope = rows.A.row(i).dot(p);
            if (slope >= -1e-14) continue;
            const double until = std::max(0.0, (rows.b(i) - rows.A.row(i).dot(x)) / slope);
            if (until >= length) continue;
            length = until;
            blocking = i;
        }
        x += length * p;
        if (blocking >= 0) active.push_back(blocking);
    }
    ADD_FAILURE() << "the reference did not end";
    return x;
}

TEST(OrderedQp, IsTheMinimumThatADenseActiveSetFinds) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (int round = 0; round < 20; ++round) {
        constexpr int n = 24;
        Eigen::MatrixXd B(n, n);
        for (Eigen::Index i = 0; i < B.size(); ++i) B.data()[i] = uniform(random);
        const Eigen::MatrixXd Q = B * B.transpose() + 0.01 * Eigen::MatrixXd::Identity(n, n);
        Eigen::VectorXd c(n), feasible(n);
        for (int i = 0; i < n; ++i) {
            c(i) = 5 * uniform(random);
            feasible(i) = (i + 0.5) / n;
        }
        // A chain with branches, between 0 and 1.
        std::vector<OrderConstraint> constraints{{-1, 0, 0}, {n - 1, -1, -1}};
        for (int i = 1; i < n; ++i) constraints.push_back({i - 1, i, 0.3 / n * (uniform(random) + 1)});
        for (int i = 4; i < n; i += 3) constraints.push_back({i - 4, i, 0});
        const Eigen::VectorXd expected = active_set_minimum(Q, c, rows_of(constraints, n), feasible);
        const OrderedQp qp(Q.sparseView());
        const auto found = qp.solve(c, constraints, Eigen::VectorXd::Zero(n), {1e-10, 100, {}});
        ASSERT_TRUE(found);
        EXPECT_TRUE(found->converged);
        EXPECT_LE(found->kkt_residual, 1e-10);
        EXPECT_LE((found->x - expected).cwiseAbs().maxCoeff(), 1e-7) << "round " << round;
    }
}

// Every constraint holds with equality at the minimum, and none has to push.
TEST(OrderedQp, IsAsRightAsItSaysWhereMultipliersVanish) {
    constexpr int n = 12;
    Eigen::MatrixXd Q = 2 * Eigen::MatrixXd::Identity(n, n);
    std::vector<OrderConstraint> constraints{{-1, 0, 0}, {n - 1, -1, -1}};
    for (int i = 1; i < n; ++i) {
        Q(i, i - 1) = Q(i - 1, i) = -0.9;
        constraints.push_back({i - 1, i, 0});
    }
    for (const double tolerance : {1e-4, 1e-6, 1e-8}) {
        const auto found =
            OrderedQp(Q.sparseView())
                .solve(Eigen::VectorXd::Zero(n), constraints, Eigen::VectorXd::Constant(n, 0.3), {tolerance, 100, {}});
        ASSERT_TRUE(found);
        EXPECT_TRUE(found->converged);
        // Q is so well conditioned that a sum of twelve such errors bounds it.
        EXPECT_LE(found->x.cwiseAbs().maxCoeff(), n * tolerance);
    }
}

TEST(OrderedQp, WithoutConstraintsIsOneSolve) {
    Eigen::Matrix3d Q;
    Q << 4, 1, 0, 1, 3, 1, 0, 1, 2;
    const Eigen::Vector3d c(1, -2, 3);
    const auto found = OrderedQp(Q.sparseView()).solve(c, {}, Eigen::Vector3d::Zero(), {1e-12, 100, {}});
    ASSERT_TRUE(found);
    EXPECT_EQ(found->iterations, 1);
    EXPECT_LE((Q * found->x + c).cwiseAbs().maxCoeff(), 1e-13);
}

TEST(OrderedQp, SaysWhenItStopsEarly) {
    const Eigen::Matrix2d Q = Eigen::Matrix2d::Identity();
    const auto found = OrderedQp(Eigen::Matrix2d(Q + 1e-9 * Eigen::Matrix2d::Ones()).sparseView())
                           .solve(Eigen::Vector2d(-1, 1), {{0, 1, 0}}, Eigen::Vector2d::Zero(), {1e-12, 2, {}});
    ASSERT_TRUE(found);
    EXPECT_FALSE(found->converged);
    EXPECT_EQ(found->iterations, 2);
    EXPECT_GT(found->kkt_residual, 1e-12);
}

TEST(OrderedQp, RefusesWhatIsNotPositiveDefinite) {
    Eigen::Matrix2d Q;
    Q << 1, 2, 2, 1;
    EXPECT_FALSE(OrderedQp(Q.sparseView()).solve(Eigen::Vector2d(1, 1), {}, Eigen::Vector2d::Zero(), {1e-8, 9, {}}));
}

}  // namespace
}  // namespace puppetwarp
