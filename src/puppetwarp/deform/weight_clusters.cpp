#include <puppetwarp/deform/weight_clusters.h>

#include <limits>
#include <vector>

namespace puppetwarp {

namespace {

// Groups settle further, but what they are for hardly gains by it.
constexpr int lloyd_rounds = 8;

// Rows are columns here: each lies in one piece.
Eigen::MatrixXd farthest_points(const Eigen::MatrixXd& points, int most) {
    Eigen::MatrixXd centres(points.rows(), most);
    const Eigen::VectorXd mean = points.rowwise().mean();
    Eigen::VectorXd distance = (points.colwise() - mean).colwise().squaredNorm();
    int count = 0;
    for (; count < most; ++count) {
        Eigen::Index farthest = 0;
        const double reach = distance.maxCoeff(&farthest);
        if (count > 0 && reach <= 0) break;
        centres.col(count) = points.col(farthest);
        const Eigen::VectorXd from_here = (points.colwise() - points.col(farthest)).colwise().squaredNorm();
        distance = count == 0 ? from_here : Eigen::VectorXd(distance.cwiseMin(from_here));
    }
    return centres.leftCols(count);
}

Eigen::VectorXi nearest_centres(const Eigen::MatrixXd& points, const Eigen::MatrixXd& centres) {
    Eigen::VectorXi group = Eigen::VectorXi::Zero(points.cols());
    Eigen::VectorXd least = Eigen::VectorXd::Constant(points.cols(), std::numeric_limits<double>::infinity());
    for (Eigen::Index c = 0; c < centres.cols(); ++c) {
        for (Eigen::Index i = 0; i < points.cols(); ++i) {
            const double distance = (points.col(i) - centres.col(c)).squaredNorm();
            if (distance >= least(i)) continue;
            least(i) = distance;
            group(i) = static_cast<int>(c);
        }
    }
    return group;
}

}  // namespace

Eigen::VectorXi weight_clusters(const Eigen::MatrixXd& rows, const Eigen::VectorXd& weights, int most) {
    const Eigen::MatrixXd points = rows.transpose();
    Eigen::MatrixXd centres = farthest_points(points, most);
    Eigen::VectorXi group = nearest_centres(points, centres);
    for (int round = 0; round < lloyd_rounds; ++round) {
        Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(centres.rows(), centres.cols());
        Eigen::VectorXd totals = Eigen::VectorXd::Zero(centres.cols());
        for (Eigen::Index i = 0; i < points.cols(); ++i) {
            sums.col(group(i)) += weights(i) * points.col(i);
            totals(group(i)) += weights(i);
        }
        for (Eigen::Index c = 0; c < centres.cols(); ++c) {
            if (totals(c) > 0) centres.col(c) = sums.col(c) / totals(c);
        }
        const Eigen::VectorXi next = nearest_centres(points, centres);
        if (next == group) break;
        group = next;
    }
    std::vector<int> number(static_cast<std::size_t>(centres.cols()), -1);
    int count = 0;
    for (int& each : group) {
        int& known = number[static_cast<std::size_t>(each)];
        if (known < 0) known = count++;
        each = known;
    }
    return group;
}

}  // namespace puppetwarp
