#include <puppetwarp/weights/mean_value.h>

#include <puppetwarp/weights/cage_polygon.h>
#include <puppetwarp/weights/segment_foot.h>

#include <cmath>

namespace puppetwarp {

namespace {

// tan(alpha / 2), alpha from a to b in (-pi, pi). The two forms are equal; each loses no digits where it is used.
double tan_half_angle(const Point& a, const Point& b, double lengths) {
    const double cross = a.x() * b.y() - a.y() * b.x(), dot = a.dot(b);
    return dot > 0 ? cross / (lengths + dot) : (lengths - dot) / cross;
}

}  // namespace

Eigen::MatrixXd mean_value_coordinates(const Eigen::MatrixX2d& P, const Polyline& cage) {
    const std::size_t n = cage.size();
    const double on_cage = on_cage_share * diagonal(cage);
    Eigen::MatrixXd W = Eigen::MatrixXd::Zero(P.rows(), static_cast<Eigen::Index>(n));
    std::vector<Point> to_corner(n);
    std::vector<double> distance(n), tangent(n);
    for (Eigen::Index i = 0; i < P.rows(); ++i) {
        const Point z = P.row(i).transpose();
        const CageFoot foot = nearest_foot(cage, z);
        if (foot.distance <= on_cage) {
            W(i, static_cast<Eigen::Index>(foot.edge)) = 1 - foot.along;
            W(i, static_cast<Eigen::Index>((foot.edge + 1) % n)) = foot.along;
            continue;
        }
        for (std::size_t j = 0; j < n; ++j) {
            to_corner[j] = cage[j] - z;
            distance[j] = to_corner[j].norm();
        }
        for (std::size_t j = 0; j < n; ++j) {
            const std::size_t next = j + 1 < n ? j + 1 : 0;
            tangent[j] = tan_half_angle(to_corner[j], to_corner[next], distance[j] * distance[next]);
        }
        double sum = 0;
        for (std::size_t j = 0; j < n; ++j) {
            const double w = (tangent[j > 0 ? j - 1 : n - 1] + tangent[j]) / distance[j];
            W(i, static_cast<Eigen::Index>(j)) = w;
            sum += w;
        }
        W.row(i) /= sum;
    }
    return W;
}

}  // namespace puppetwarp
