#include <puppetwarp/rig/binding.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/mesh/locate.h>
#include <puppetwarp/mesh/operators.h>

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace puppetwarp {

namespace {

using Complex = std::complex<double>;

Complex complex_of(const Point& p) {
    return {p.x(), p.y()};
}

// What taking hold needs to know of a mesh, computed once for all handles.
class Holder {
public:
    explicit Holder(const TriangleMesh& mesh)
        : mesh_(mesh),
          locator_(mesh),
          component_(vertex_components(mesh)),
          mass_(lumped_mass(mesh)),
          gradients_(hat_gradients(mesh)),
          double_areas_(double_areas(mesh.V, mesh.F).cwiseAbs()),
          size_(bounding_diagonal(mesh.V)),
          triangles_at_(static_cast<std::size_t>(mesh.V.rows())) {
        for (int t = 0; t < mesh.F.rows(); ++t) {
            for (int k = 0; k < 3; ++k) triangles_at_[static_cast<std::size_t>(mesh.F(t, k))].push_back(t);
        }
    }

    Hold hold_point(const std::string& id, const PointHandle& point) const;
    Hold hold_vertex(const std::string& id, const VertexHandle& vertex) const;

private:
    double distance(int vertex, const Point& p) const { return (mesh_.V.row(vertex).transpose() - p).norm(); }
    std::vector<int> reachable(int triangle, const Point& centre, double radius) const;
    bool centre_mean(ComplexRow& row, const Point& centre) const;
    double longest_edge(int triangle) const;
    ComplexRow mean_over_disc(const std::vector<int>& vertices, const Point& centre, double radius) const;
    ComplexRow turn_over_disc(const std::vector<int>& vertices, const Point& centre, double radius, int triangle) const;

    const TriangleMesh& mesh_;
    MeshLocator locator_;
    Eigen::VectorXi component_;
    Eigen::VectorXd mass_;
    Eigen::MatrixX3cd gradients_;
    Eigen::VectorXd double_areas_;
    double size_;
    std::vector<std::vector<int>> triangles_at_;
};

// Vertices inside the disc that edges inside the disc connect with the triangle: what lies beside it across a gap stays
// free. Ascending.
std::vector<int> Holder::reachable(int triangle, const Point& centre, double radius) const {
    std::vector<int> found;
    std::vector<bool> seen(static_cast<std::size_t>(mesh_.V.rows()));
    const auto visit = [&](int t) {
        for (int k = 0; k < 3; ++k) {
            const int v = mesh_.F(t, k);
            if (seen[static_cast<std::size_t>(v)] || distance(v, centre) >= radius) continue;
            seen[static_cast<std::size_t>(v)] = true;
            found.push_back(v);
        }
    };
    visit(triangle);
    for (std::size_t next = 0; next < found.size(); ++next) {
        for (const int t : triangles_at_[static_cast<std::size_t>(found[next])]) visit(t);
    }
    std::sort(found.begin(), found.end());
    return found;
}

// Smooth, so that the hold hardly changes when a vertex enters or leaves the disc.
double kernel(double distance, double radius) {
    const double q = distance / radius;
    return q < 1 ? (1 - q * q) * (1 - q * q) : 0;
}

ComplexRow Holder::mean_over_disc(const std::vector<int>& vertices, const Point& centre, double radius) const {
    ComplexRow row;
    double sum = 0;
    for (const int v : vertices) {
        const double weight = mass_(v) * kernel(distance(v, centre), radius);
        row.emplace_back(v, weight);
        sum += weight;
    }
    for (auto& [vertex, weight] : row) weight /= sum;
    return row;
}

// Tilts the weights so that the mean lies at the centre itself: what follows a rigid motion of the handle is then the
// rigid motion. \return false, and nothing is changed, where a weight would turn negative.
bool Holder::centre_mean(ComplexRow& row, const Point& centre) const {
    Eigen::Vector2d first = Eigen::Vector2d::Zero();
    Eigen::Matrix2d second = Eigen::Matrix2d::Zero();
    const auto arm = [&](int vertex) -> Eigen::Vector2d { return mesh_.V.row(vertex).transpose() - centre; };
    for (const auto& [vertex, weight] : row) {
        first += weight.real() * arm(vertex);
        second += weight.real() * arm(vertex) * arm(vertex).transpose();
    }
    const Eigen::Vector2d tilt = -second.ldlt().solve(first);
    const double scale = 1 / (1 + first.dot(tilt));
    for (const auto& [vertex, weight] : row) {
        if (!(scale * (1 + tilt.dot(arm(vertex))) > 0)) return false;
    }
    for (auto& [vertex, weight] : row) weight *= scale * (1 + tilt.dot(arm(vertex)));
    return true;
}

ComplexRow Holder::turn_over_disc(const std::vector<int>& vertices, const Point& centre, double radius,
                                  int triangle) const {
    std::vector<int> triangles;
    for (const int v : vertices) {
        const auto& at = triangles_at_[static_cast<std::size_t>(v)];
        triangles.insert(triangles.end(), at.begin(), at.end());
    }
    std::sort(triangles.begin(), triangles.end());
    triangles.erase(std::unique(triangles.begin(), triangles.end()), triangles.end());

    std::vector<std::pair<int, double>> weights;
    double sum = 0;
    for (const int t : triangles) {
        const Point centroid =
            (mesh_.V.row(mesh_.F(t, 0)) + mesh_.V.row(mesh_.F(t, 1)) + mesh_.V.row(mesh_.F(t, 2))) / 3;
        const double weight = double_areas_(t) * kernel((centroid - centre).norm(), radius);
        if (weight <= 0) continue;
        weights.emplace_back(t, weight);
        sum += weight;
    }
    if (weights.empty()) {
        weights.emplace_back(triangle, 1);
        sum = 1;
    }

    // f_z = sum over the corners of 1/2 conj(g_k) w_k.
    ComplexRow row;
    for (const auto& [t, weight] : weights) {
        for (int k = 0; k < 3; ++k) row.emplace_back(mesh_.F(t, k), std::conj(gradients_(t, k)) * (0.5 * weight / sum));
    }
    std::stable_sort(row.begin(), row.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    ComplexRow merged;
    for (const auto& entry : row) {
        if (!merged.empty() && merged.back().first == entry.first) {
            merged.back().second += entry.second;
        } else {
            merged.push_back(entry);
        }
    }
    return merged;
}

double Holder::longest_edge(int triangle) const {
    double longest = 0;
    for (int k = 0; k < 3; ++k) {
        const Point p = mesh_.V.row(mesh_.F(triangle, k)), q = mesh_.V.row(mesh_.F(triangle, (k + 1) % 3));
        longest = std::max(longest, (q - p).norm());
    }
    return longest;
}

Hold Holder::hold_point(const std::string& id, const PointHandle& point) const {
    const MeshLocation location = locator_.locate(point.at);
    if (location.distance_px > on_border * size_) throw_outside(id, location.distance_px);

    Hold hold;
    hold.id = id;
    hold.at = complex_of(point.at);
    hold.component = component_(mesh_.F(location.triangle, 0));
    hold.radius_px = point.radius_px.value_or(default_disc_share * size_);
    std::vector<int> vertices = reachable(location.triangle, point.at, hold.radius_px);
    if (vertices.size() >= 3) hold.mean = mean_over_disc(vertices, point.at, hold.radius_px);
    const bool centred = vertices.size() >= 3 && centre_mean(hold.mean, point.at);
    // Where the outline cuts the disc, its mean lies inside of the point and stays there. A disc that is smaller than
    // the triangles around it has no mean worth the name: the triangle takes its place.
    if (!centred && (vertices.size() < 3 || hold.radius_px < longest_edge(location.triangle))) {
        vertices.clear();
        hold.mean.clear();
        hold.radius_px = std::sqrt(double_areas_(location.triangle));
        for (int k = 0; k < 3; ++k) {
            const double weight = location.barycentric(k);
            if (weight > 0) hold.mean.emplace_back(mesh_.F(location.triangle, k), weight);
        }
    }
    hold.turn = turn_over_disc(vertices, point.at, hold.radius_px, location.triangle);
    return hold;
}

Hold Holder::hold_vertex(const std::string& id, const VertexHandle& vertex) const {
    if (vertex.index < 0 || vertex.index >= mesh_.V.rows()) {
        throw InvalidInput("handle '" + id + "'", "index " + std::to_string(vertex.index) +
                                                      " is not a vertex: the mesh has " +
                                                      std::to_string(mesh_.V.rows()));
    }
    Hold hold;
    hold.id = id;
    hold.at = complex_of(mesh_.V.row(vertex.index).transpose());
    hold.component = component_(vertex.index);
    hold.hard = true;
    hold.mean.emplace_back(vertex.index, 1.0);
    return hold;
}

[[noreturn]] void throw_unusable(const Handle& handle, const char* type, std::string_view user) {
    throw InvalidInput("handle '" + handle.id + "'",
                       std::string("a ") + type + " cannot drive '" + std::string(user) + "'",
                       "use points, or vertices of a mesh file");
}

struct TakeHold {
    const Holder& holder;
    const Handle& handle;
    std::string_view user;

    Hold operator()(const PointHandle& point) const { return holder.hold_point(handle.id, point); }
    Hold operator()(const VertexHandle& vertex) const { return holder.hold_vertex(handle.id, vertex); }
    Hold operator()(const BoneHandle&) const { throw_unusable(handle, "bone", user); }
    Hold operator()(const CageHandle&) const { throw_unusable(handle, "cage", user); }
    Hold operator()(const RegionHandle&) const { throw_unusable(handle, "region", user); }
};

HoldTarget target_of(const Hold& hold, const HandlePose& pose, std::string_view user) {
    const std::string subject = "handle '" + hold.id + "'";
    if (pose.affine) {
        throw InvalidInput(subject, "'" + std::string(user) + "' cannot use an affine map",
                           "give to, rotate_deg and scale");
    }
    if (pose.scale && !pose.rotate_rad) {
        throw InvalidInput(subject, "'" + std::string(user) + "' can set a scale only together with an angle",
                           "give rotate_deg too");
    }
    HoldTarget target;
    if (pose.to) target.move = complex_of(*pose.to) - hold.at;
    target.rotate_rad = pose.rotate_rad;
    target.scale = pose.scale;
    return target;
}

bool same_turn(const HoldTarget& a, const HoldTarget& b) {
    constexpr double tolerance = 1e-9;
    if (!a.rotate_rad || !b.rotate_rad) return true;
    if (std::abs(std::polar(1.0, *a.rotate_rad) - std::polar(1.0, *b.rotate_rad)) > tolerance) return false;
    return !a.scale || !b.scale || std::abs(*a.scale - *b.scale) <= tolerance;
}

// An even-odd test; a point on an edge may fall on either side.
bool inside(const Polyline& polygon, const Point& p) {
    bool in = false;
    for (std::size_t i = 0, j = polygon.size() - 1; i < polygon.size(); j = i++) {
        const Point& a = polygon[i];
        const Point& b = polygon[j];
        if ((a.y() > p.y()) == (b.y() > p.y())) continue;
        if (p.x() < a.x() + (b.x() - a.x()) * (p.y() - a.y()) / (b.y() - a.y())) in = !in;
    }
    return in;
}

}  // namespace

std::vector<Hold> take_hold(const TriangleMesh& mesh, const Rig& rig, std::string_view user) {
    if (rig.handles.empty()) throw InvalidInput("rig", "it has no handles", "set at least one");
    const Holder holder(mesh);
    std::vector<Hold> holds;
    holds.reserve(rig.handles.size());
    for (const Handle& handle : rig.handles) holds.push_back(std::visit(TakeHold{holder, handle, user}, handle.shape));
    return holds;
}

std::vector<HoldTarget> resolve(const std::vector<Hold>& holds, const Rig& rig, const Pose& pose, double size,
                                std::string_view user) {
    require_sound(pose, rig);
    std::vector<HoldTarget> targets(holds.size());
    for (std::size_t i = 0; i < holds.size(); ++i) {
        const auto found = pose.handles.find(holds[i].id);
        if (found != pose.handles.end()) targets[i] = target_of(holds[i], found->second, user);
        if (!(std::abs(targets[i].move) <= farthest_move * size)) {
            throw InvalidInput("handle '" + holds[i].id + "'", "its target is too far away",
                               "stay within a million times the subject's size");
        }
        for (std::size_t j = 0; j < i; ++j) {
            const double near = (holds[i].hard || holds[j].hard ? one_vertex : one_place) * size;
            if (std::abs(holds[i].at - holds[j].at) > near) continue;
            if (std::abs(targets[i].move - targets[j].move) <= near && same_turn(targets[i], targets[j])) continue;
            throw InvalidInput("handles '" + holds[j].id + "' and '" + holds[i].id + "'",
                               "they are in one place but are sent to different ones", "remove one of them");
        }
    }
    return targets;
}

Eigen::VectorXd triangle_stiffness(const TriangleMesh& mesh, const std::vector<StiffnessRegion>& regions) {
    if (regions.empty()) return {};
    Eigen::VectorXd stiffness = Eigen::VectorXd::Ones(mesh.F.rows());
    for (Eigen::Index t = 0; t < mesh.F.rows(); ++t) {
        const Point centroid = (mesh.V.row(mesh.F(t, 0)) + mesh.V.row(mesh.F(t, 1)) + mesh.V.row(mesh.F(t, 2))) / 3;
        for (const StiffnessRegion& region : regions) {
            if (inside(region.points, centroid)) stiffness(t) *= region.value;
        }
    }
    return stiffness;
}

void throw_outside(const std::string& id, double distance_px) {
    // Three digits, but never the nought that would say it is inside.
    char distance[64];
    std::snprintf(distance, sizeof distance, "%.3g", distance_px);
    throw InvalidInput("handle '" + id + "'", std::string("lies ") + distance + " px outside the subject",
                       "--pin-snap PX moves it onto the subject");
}

Complex row_value(const ComplexRow& row, const Eigen::VectorXcd& x) {
    Complex sum = 0;
    for (const auto& [vertex, coefficient] : row) sum += coefficient * x(vertex);
    return sum;
}

Eigen::VectorXcd complex_positions(const Eigen::MatrixX2d& V) {
    Eigen::VectorXcd x(V.rows());
    for (Eigen::Index v = 0; v < V.rows(); ++v) x(v) = Complex(V(v, 0), V(v, 1));
    return x;
}

Eigen::MatrixX2d point_positions(const Eigen::VectorXcd& x) {
    Eigen::MatrixX2d V(x.size(), 2);
    V.col(0) = x.real();
    V.col(1) = x.imag();
    return V;
}

}  // namespace puppetwarp
