#include <puppetwarp/weights/shepard.h>

#include <puppetwarp/rig/region.h>
#include <puppetwarp/weights/segment_foot.h>
#include <puppetwarp/weights/weight_problem.h>

#include <algorithm>
#include <limits>

namespace puppetwarp {

namespace {

// What a column gets from one source at this distance.
struct Share {
    Eigen::Index column;
    double part;
    double distance;
};

class Shares {
public:
    Shares(const TriangleMesh& mesh, const Point& p, std::vector<Share>& found) : mesh_(mesh), p_(p), found_(found) {}

    void operator()(const PointHandle& point) { add((point.at - p_).norm()); }
    void operator()(const VertexHandle& vertex) { add((mesh_.V.row(vertex.index).transpose() - p_).norm()); }
    void operator()(const BoneHandle& bone) { add(segment_foot(bone.from, bone.to, p_).distance); }
    void operator()(const RegionHandle& region) {
        double distance = inside(region.points, p_) ? 0 : std::numeric_limits<double>::infinity();
        for (std::size_t k = 0; k < region.points.size(); ++k) {
            const Point& next = region.points[(k + 1) % region.points.size()];
            distance = std::min(distance, segment_foot(region.points[k], next, p_).distance);
        }
        add(distance);
    }
    void operator()(const CageHandle& cage) {
        const std::size_t corners = cage.points.size();
        for (std::size_t k = 0; k < corners; ++k) {
            const std::size_t next = (k + 1) % corners;
            const SegmentFoot foot = segment_foot(cage.points[k], cage.points[next], p_);
            found_.push_back({column_ + static_cast<Eigen::Index>(k), 1 - foot.along, foot.distance});
            found_.push_back({column_ + static_cast<Eigen::Index>(next), foot.along, foot.distance});
        }
        column_ += static_cast<Eigen::Index>(corners);
    }

private:
    void add(double distance) { found_.push_back({column_++, 1, distance}); }

    const TriangleMesh& mesh_;
    const Point& p_;
    std::vector<Share>& found_;
    Eigen::Index column_ = 0;
};

}  // namespace

Eigen::MatrixXd shepard_weights(const TriangleMesh& mesh, const Rig& rig) {
    const auto columns = static_cast<Eigen::Index>(weight_columns(rig).size());
    Eigen::MatrixXd W = Eigen::MatrixXd::Zero(mesh.V.rows(), columns);
    std::vector<Share> shares;
    for (Eigen::Index v = 0; v < mesh.V.rows(); ++v) {
        shares.clear();
        const Point p = mesh.V.row(v).transpose();
        Shares collect(mesh, p, shares);
        for (const Handle& handle : rig.handles) std::visit(collect, handle.shape);
        double nearest = std::numeric_limits<double>::infinity();
        for (const Share& share : shares) nearest = std::min(nearest, share.distance);
        for (const Share& share : shares) {
            // Relative to the nearest: distances squared may overflow or vanish.
            const double ratio = share.distance > 0 ? nearest / share.distance : 1;
            W(v, share.column) += share.part * ratio * ratio;
        }
        W.row(v) /= W.row(v).sum();
    }
    return W;
}

}  // namespace puppetwarp
