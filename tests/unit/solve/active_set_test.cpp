// Box and simplex constrained programs, small enough to try every set of active constraints.
#include <puppetwarp/solve/box_qp.h>
#include <puppetwarp/solve/simplex_qp.h>

#include <gtest/gtest.h>
#include <Eigen/Dense>

#include <limits>
#include <random>

namespace puppetwarp {
namespace {

class Random {
public:
    explicit Random(std::uint32_t seed) : engine_(seed) {}
    double between(double low, double high) { return low + (high - low) * (engine_() / 4294967296.0); }
    Eigen::MatrixXd matrix(Eigen::Index rows, Eigen::Index cols) {
        Eigen::MatrixXd M(rows, cols);
        for (double& value : M.reshaped()) value = between(-1, 1);
        return M;
    }
    //! Far from an M-matrix, so that primal-dual active sets go in circles now and then.
    Eigen::MatrixXd positive_definite(Eigen::Index n) {
        const Eigen::MatrixXd B = matrix(n, 2);
        return B * B.transpose() + 0.01 * Eigen::MatrixXd::Identity(n, n);
    }

private:
    std::mt19937 engine_;
};

// Each variable at its lower bound, at its upper one, or between.
Eigen::VectorXd best_in_box(const Eigen::MatrixXd& Q, const Eigen::VectorXd& c, const Eigen::VectorXd& lower,
                            const Eigen::VectorXd& upper) {
    const Eigen::Index n = c.size();
    Eigen::VectorXd best;
    double least = std::numeric_limits<double>::infinity();
    const auto sets = static_cast<int>(std::lround(std::pow(3, n)));
    for (int set = 0; set < sets; ++set) {
        std::vector<Eigen::Index> free;
        Eigen::VectorXd x = lower;
        for (Eigen::Index v = 0, digits = set; v < n; ++v, digits /= 3) {
            if (digits % 3 == 1) x(v) = upper(v);
            if (digits % 3 != 2) continue;
            x(v) = 0;
            free.push_back(v);
        }
        if (!free.empty()) {
            const Eigen::VectorXd load = Q * x + c;
            const Eigen::VectorXd solved = Eigen::MatrixXd(Q(free, free)).llt().solve(-load(free));
            x(free) = solved;
        }
        if ((x - lower).minCoeff() < -1e-12 || (upper - x).minCoeff() < -1e-12) continue;
        const double energy = 0.5 * x.dot(Q * x) + c.dot(x);
        if (energy >= least) continue;
        least = energy;
        best = x;
    }
    return best;
}

TEST(BoxQp, IsTheBestOfAllSets) {
    Random random(3);
    int safeguarded = 0;
    for (int round = 0; round < 300; ++round) {
        constexpr Eigen::Index n = 6;
        const Eigen::MatrixXd Q = random.positive_definite(n);
        const Eigen::VectorXd c = random.matrix(n, 1);
        const Eigen::VectorXd lower = 0.3 * random.matrix(n, 1);
        Eigen::VectorXd upper = lower + (random.matrix(n, 1).array() + 1).matrix();
        if (round % 3 == 0) upper(2) = lower(2);  // given
        const Eigen::VectorXd start = random.matrix(n, 1);
        const Eigen::SparseMatrix<double> sparse = Q.sparseView();
        const auto found = solve_box_qp({sparse, c, lower, upper}, start, {1e-11, 100, {}});
        ASSERT_TRUE(found);
        EXPECT_TRUE(found->converged) << round;
        EXPECT_LE(found->kkt_residual, 1e-11) << round;
        EXPECT_LE((found->x - best_in_box(Q, c, lower, upper)).cwiseAbs().maxCoeff(), 1e-8) << round;
        safeguarded += found->safeguarded;
    }
    EXPECT_GT(safeguarded, 0) << "projected Newton steps are not tested";
    EXPECT_LT(safeguarded, 150);
}

// All choices of which shares of each row are not 0.
Eigen::MatrixXd best_on_simplices(const Eigen::MatrixXd& Q, const Eigen::MatrixXd& given_row) {
    const Eigen::Index n = Q.rows(), m = given_row.cols(), free_rows = n - 1;
    Eigen::MatrixXd best;
    double least = std::numeric_limits<double>::infinity();
    for (int set = 0; set < 1 << (free_rows * m); ++set) {
        // Unknowns: shares of the free rows in the set, then a multiplier for each sum.
        std::vector<std::pair<Eigen::Index, Eigen::Index>> shares;
        std::vector<int> count(static_cast<std::size_t>(n), 0);
        for (Eigen::Index k = 0; k < free_rows * m; ++k) {
            if ((set >> k & 1) == 0) continue;
            shares.emplace_back(1 + k / m, k % m);
            ++count[static_cast<std::size_t>(1 + k / m)];
        }
        if (std::count(count.begin() + 1, count.end(), 0) > 0) continue;
        const auto size = static_cast<Eigen::Index>(shares.size());
        Eigen::MatrixXd K = Eigen::MatrixXd::Zero(size + free_rows, size + free_rows);
        Eigen::VectorXd b = Eigen::VectorXd::Zero(size + free_rows);
        b.tail(free_rows).setOnes();
        for (Eigen::Index i = 0; i < size; ++i) {
            const auto& [v, j] = shares[static_cast<std::size_t>(i)];
            for (Eigen::Index k = 0; k < size; ++k) {
                const auto& [u, l] = shares[static_cast<std::size_t>(k)];
                if (j == l) K(i, k) = Q(v, u);
            }
            K(i, size + v - 1) = K(size + v - 1, i) = 1;
            b(i) = -Q(v, 0) * given_row(0, j);
        }
        const Eigen::VectorXd solved = K.fullPivLu().solve(b);
        Eigen::MatrixXd W = Eigen::MatrixXd::Zero(n, m);
        W.row(0) = given_row;
        for (Eigen::Index i = 0; i < size; ++i) {
            W(shares[static_cast<std::size_t>(i)].first, shares[static_cast<std::size_t>(i)].second) = solved(i);
        }
        if (W.minCoeff() < -1e-12) continue;
        const double energy = W.cwiseProduct(Q * W).sum();
        if (energy >= least) continue;
        least = energy;
        best = W;
    }
    return best;
}

TEST(SimplexQp, IsTheBestOfAllSets) {
    Random random(5);
    for (int round = 0; round < 100; ++round) {
        constexpr Eigen::Index n = 4, m = 3;
        const Eigen::MatrixXd Q = random.positive_definite(n);
        Shares start = (random.matrix(n, m).array() + 1).matrix();
        for (Eigen::Index k = 0; k < start.size(); k += 2) start(k) = round % 2 == 0 ? 0 : start(k);
        start.col(1).array() += 0.1;
        start.row(0) /= start.row(0).sum();
        const Eigen::SparseMatrix<double> sparse = Q.sparseView();
        const std::vector<char> given{1, 0, 0, 0};
        const auto found = solve_simplex_qp({sparse, given}, start, {1e-11, 100, {}});
        ASSERT_TRUE(found);
        EXPECT_TRUE(found->converged) << round;
        EXPECT_LE(found->kkt_residual, 1e-11) << round;
        EXPECT_GE(found->W.minCoeff(), 0);
        EXPECT_LE((found->W.rowwise().sum().array() - 1).abs().maxCoeff(), 1e-15);
        EXPECT_LE((found->W - best_on_simplices(Q, start.row(0))).cwiseAbs().maxCoeff(), 1e-8) << round;
    }
}

// Sixty variables; and a rod of as many points with four shares, given at five of them.
struct Larger {
    Eigen::SparseMatrix<double> Q, bending;
    Eigen::VectorXd c, lower = Eigen::VectorXd::Zero(60), upper = Eigen::VectorXd::Ones(60);
    Shares start = Shares::Constant(60, 4, 0.25);
    std::vector<char> given = std::vector<char>(60, 0);

    Larger() {
        Random random(8);
        Q = random.positive_definite(60).sparseView();
        c = random.matrix(60, 1);
        Eigen::MatrixXd second = Eigen::MatrixXd::Zero(58, 60);
        for (Eigen::Index i = 0; i < 58; ++i) second.block<1, 3>(i, i) << 1, -2, 1;
        bending = Eigen::MatrixXd(second.transpose() * second).sparseView();
        for (Eigen::Index v = 5; v < 60; v += 13) {
            start.row(v).setZero();
            start(v, v % 4) = 1;
            given[static_cast<std::size_t>(v)] = 1;
        }
    }
    BoxQpSolution box(const QpOptions& options) const { return *solve_box_qp({Q, c, lower, upper}, c, options); }
    SimplexQpSolution simplex(const QpOptions& options) const {
        return *solve_simplex_qp({bending, given}, start, options);
    }
};

// The tolerance holds for what is returned: after the clipping of what many active constraints leave.
TEST(ActiveSets, MeetTheirToleranceHoweverTightItIs) {
    const Larger qp;
    for (const double tolerance : {1e-3, 1e-5, 1e-8, 1e-11}) {
        EXPECT_TRUE(qp.box({tolerance, 400, {}}).converged) << tolerance;
        const SimplexQpSolution simplex = qp.simplex({tolerance, 400, {}});
        EXPECT_TRUE(simplex.converged) << tolerance;
        EXPECT_LE(simplex_kkt_residual({qp.bending, qp.given}, simplex.W), tolerance);
    }
}

// Half of the iterations are the active set's: with one too few, projected Newton steps have to end it.
TEST(ActiveSets, ProjectedNewtonStepsEndWhatTheyLeave) {
    const Larger qp;
    const BoxQpSolution box = qp.box({1e-11, 400, {}});
    ASSERT_FALSE(box.safeguarded);
    ASSERT_GT(box.iterations, 2);
    const BoxQpSolution safe_box = qp.box({1e-11, 2 * (box.iterations - 1), {}});
    EXPECT_TRUE(safe_box.safeguarded);
    EXPECT_TRUE(safe_box.converged);
    EXPECT_LE((safe_box.x - box.x).cwiseAbs().maxCoeff(), 1e-8);
    const SimplexQpSolution simplex = qp.simplex({1e-11, 400, {}});
    ASSERT_FALSE(simplex.safeguarded);
    ASSERT_GT(simplex.iterations, 2);
    const SimplexQpSolution safe_simplex = qp.simplex({1e-11, 2 * (simplex.iterations - 1), {}});
    EXPECT_TRUE(safe_simplex.safeguarded);
    EXPECT_TRUE(safe_simplex.converged);
    EXPECT_LE((safe_simplex.W - simplex.W).cwiseAbs().maxCoeff(), 1e-8);
}

TEST(ActiveSets, SayWhenTheyStopEarly) {
    const Larger qp;
    const BoxQpSolution box = qp.box({1e-11, 1, {}});
    EXPECT_FALSE(box.converged);
    EXPECT_GT(box.kkt_residual, 1e-11);
    EXPECT_GE(box.x.minCoeff(), 0);
    EXPECT_LE(box.x.maxCoeff(), 1);
    const SimplexQpSolution simplex = qp.simplex({1e-11, 1, {}});
    EXPECT_FALSE(simplex.converged);
    EXPECT_GE(simplex.W.minCoeff(), 0);
    EXPECT_LE((simplex.W.rowwise().sum().array() - 1).abs().maxCoeff(), 1e-15);
}

TEST(ActiveSets, RefuseWhatIsNotPositiveDefinite) {
    Eigen::Matrix2d Q;
    Q << 1, 2, 2, 1;
    const Eigen::SparseMatrix<double> sparse = Q.sparseView();
    const Eigen::Vector2d zero = Eigen::Vector2d::Zero(), one = Eigen::Vector2d::Ones();
    EXPECT_FALSE(solve_box_qp({sparse, zero, -one, one}, zero, {1e-8, 50, {}}));
    const std::vector<char> given(2, 0);
    EXPECT_FALSE(solve_simplex_qp({sparse, given}, Shares::Constant(2, 2, 0.5), {1e-8, 50, {}}));
}

}  // namespace
}  // namespace puppetwarp
