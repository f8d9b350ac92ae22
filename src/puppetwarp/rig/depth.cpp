#include <puppetwarp/rig/depth.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/mesh/operators.h>
#include <puppetwarp/rig/disc_holder.h>
#include <puppetwarp/rig/region.h>
#include <puppetwarp/solve/cholesky.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace puppetwarp {

namespace {

constexpr double most_gaps = 1000;  // between the discs of a bone
constexpr double not_held = std::numeric_limits<double>::quiet_NaN();

std::optional<double> own_depth(const Pose& pose, const std::string& id) {
    const auto found = pose.handles.find(id);
    return found == pose.handles.end() ? std::nullopt : found->second.depth;
}

// The nearest depth up a bone's parents. Sound rigs have no loops.
std::optional<double> given_depth(const Rig& rig, const Pose& pose, const Handle& handle) {
    const std::optional<double> depth = own_depth(pose, handle.id);
    const auto* bone = std::get_if<BoneHandle>(&handle.shape);
    if (depth || bone == nullptr || bone->parent.empty()) return depth;
    return given_depth(rig, pose, *find_handle(rig, bone->parent));
}

// Lays down what handles hold; what is held already stays.
class DepthHolder {
public:
    explicit DepthHolder(const TriangleMesh& mesh)
        : mesh_(mesh),
          discs_(mesh),
          radius_(default_disc_share * discs_.size()),
          held_(Eigen::VectorXd::Constant(mesh.V.rows(), not_held)) {}

    void hold(const Handle& handle, double depth) {
        depth_ = depth;
        std::visit([this](const auto& shape) { hold(shape); }, handle.shape);
    }

    const Eigen::VectorXd& held() const { return held_; }
    const Eigen::VectorXi& component() const { return discs_.component(); }

private:
    void hold(Eigen::Index vertex) {
        if (std::isnan(held_(vertex))) held_(vertex) = depth_;
    }
    void hold_disc(const Point& at, double radius) {
        const MeshLocation place = discs_.locate(at);
        if (discs_.outside(place)) return;
        for (const auto& entry : discs_.hold(place, at, radius).mean) hold(Eigen::Index{entry.first});
    }
    void hold_inside(const Polyline& polygon) {
        for (Eigen::Index v = 0; v < mesh_.V.rows(); ++v) {
            if (inside(polygon, mesh_.V.row(v).transpose())) hold(v);
        }
    }
    void hold(const PointHandle& point) { hold_disc(point.at, point.radius_px.value_or(radius_)); }
    void hold(const BoneHandle& bone) {
        // Bones may reach far beyond the subject.
        const double length = (bone.to - bone.from).norm();
        const int gaps = static_cast<int>(std::clamp(std::ceil(length / radius_), 1.0, most_gaps));
        for (int i = 0; i <= gaps; ++i) {
            hold_disc(bone.from + (bone.to - bone.from) * (static_cast<double>(i) / gaps), radius_);
        }
    }
    void hold(const RegionHandle& region) { hold_inside(region.points); }
    void hold(const CageHandle& cage) { hold_inside(cage.points); }
    void hold(const VertexHandle& vertex) {
        if (vertex.index >= 0 && vertex.index < mesh_.V.rows()) hold(Eigen::Index{vertex.index});
    }

    const TriangleMesh& mesh_;
    DiscHolder discs_;
    double radius_;  // of discs that say none
    double depth_ = 0;
    Eigen::VectorXd held_;  // #V, NaN where nothing is
};

// Components that are held at one depth have it everywhere, to the bit; those that are not held have 0.
void settle_uniform_components(const Eigen::VectorXi& component, Eigen::VectorXd& depth) {
    struct Range {
        double low = std::numeric_limits<double>::infinity();
        double high = -std::numeric_limits<double>::infinity();
    };
    std::vector<Range> ranges(static_cast<std::size_t>(component.maxCoeff()) + 1);
    const auto range_of = [&](Eigen::Index v) -> Range& { return ranges[static_cast<std::size_t>(component(v))]; };
    for (Eigen::Index v = 0; v < depth.size(); ++v) {
        if (std::isnan(depth(v))) continue;
        range_of(v).low = std::min(range_of(v).low, depth(v));
        range_of(v).high = std::max(range_of(v).high, depth(v));
    }
    for (Eigen::Index v = 0; v < depth.size(); ++v) {
        const Range& range = range_of(v);
        if (range.low > range.high) depth(v) = 0;
        if (range.low == range.high) depth(v) = range.low;
    }
}

// Fills in what is NaN so that the Dirichlet energy is least.
void extend_harmonically(const TriangleMesh& mesh, Eigen::VectorXd& depth) {
    std::vector<int> index(static_cast<std::size_t>(depth.size()), -1);
    int count = 0;
    for (Eigen::Index v = 0; v < depth.size(); ++v) {
        if (std::isnan(depth(v))) index[static_cast<std::size_t>(v)] = count++;
    }
    if (count == 0) return;
    const SparseMatrix L = cotangent_stiffness(mesh);
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::VectorXd x = Eigen::VectorXd::Zero(count);
    for (Eigen::Index column = 0; column < L.outerSize(); ++column) {
        const int j = index[static_cast<std::size_t>(column)];
        for (SparseMatrix::InnerIterator entry(L, column); entry; ++entry) {
            const int i = index[static_cast<std::size_t>(entry.row())];
            if (i >= 0 && j < 0) x(i) -= entry.value() * depth(column);
            if (i >= j && j >= 0) entries.emplace_back(i, j, entry.value());
        }
    }
    SparseMatrix lower(count, count);
    lower.setFromTriplets(entries.begin(), entries.end());
    const std::optional<CholeskyFactor> factor = CholeskyPattern(lower).factorise(lower);
    if (factor) factor->solve_in_place(x);
    if (!factor || !x.allFinite()) {
        throw InvalidInput("mesh", "its triangles are too thin or too different in size to compute with",
                           "use a mesh with better triangles");
    }
    for (Eigen::Index v = 0; v < depth.size(); ++v) {
        if (const int i = index[static_cast<std::size_t>(v)]; i >= 0) depth(v) = x(i);
    }
}

}  // namespace

Eigen::VectorXd vertex_depths(const TriangleMesh& mesh, const Rig& rig, const Pose& pose) {
    const bool any = std::any_of(pose.handles.begin(), pose.handles.end(),
                                 [](const auto& entry) { return entry.second.depth.has_value(); });
    if (!any || mesh.V.rows() == 0) return {};
    DepthHolder holder(mesh);
    for (const Handle& handle : rig.handles) {
        if (const auto depth = given_depth(rig, pose, handle)) holder.hold(handle, *depth);
    }
    for (const Handle& handle : rig.handles) {
        if (given_depth(rig, pose, handle) || std::holds_alternative<CageHandle>(handle.shape)) continue;
        holder.hold(handle, 0);
    }
    Eigen::VectorXd depth = holder.held();
    settle_uniform_components(holder.component(), depth);
    extend_harmonically(mesh, depth);
    return depth;
}

}  // namespace puppetwarp
