#include <puppetwarp/project/weights_cache.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/base/input_file.h>
#include <puppetwarp/base/output_file.h>

#include <glib.h>
#include <nlohmann/json.hpp>

#include <cstring>
#include <memory>
#include <optional>
#include <type_traits>

namespace puppetwarp {

namespace {

using Json = nlohmann::json;

// Raised whenever the same input gives other weights than before.
constexpr int revision = 2;
constexpr std::size_t largest_file = std::size_t{256} << 20;
constexpr std::size_t digest_length = 64;
constexpr char format_line[] = "puppetwarp weights 1\n";

// SHA-256 of a sequence of values.
class Digest {
public:
    Digest() : sum_(g_checksum_new(G_CHECKSUM_SHA256), g_checksum_free) {}

    void add(const void* bytes, std::size_t count) {
        g_checksum_update(sum_.get(), static_cast<const guchar*>(bytes), static_cast<gssize>(count));
    }
    template <typename Value>
    requires std::is_arithmetic_v<Value>
    void add(Value value) { add(&value, sizeof value); }
    template <typename Matrix>
    void add_matrix(const Matrix& matrix) {
        add(static_cast<std::int64_t>(matrix.rows()));
        add(static_cast<std::int64_t>(matrix.cols()));
        add(matrix.data(), sizeof(*matrix.data()) * static_cast<std::size_t>(matrix.size()));
    }
    void add(const std::string& text) {
        add(text.size());
        add(text.data(), text.size());
    }
    std::string text() const { return g_checksum_get_string(sum_.get()); }

private:
    std::unique_ptr<GChecksum, decltype(&g_checksum_free)> sum_;
};

void add_points(Digest& digest, const Polyline& points) {
    digest.add(points.size());
    for (const Point& p : points) digest.add_matrix(p);
}

struct AddShape {
    Digest& digest;

    void operator()(const PointHandle& point) const { digest.add_matrix(point.at); }
    void operator()(const BoneHandle& bone) const { add_points(digest, {bone.from, bone.to}); }
    void operator()(const CageHandle& cage) const { add_points(digest, cage.points); }
    void operator()(const RegionHandle& region) const { add_points(digest, region.points); }
    void operator()(const VertexHandle& vertex) const { digest.add(vertex.index); }
};

// All of it: a cage's weights are solved on more than the subject, which meets more of the stiffness.
struct AddStiffness {
    Digest& digest;

    void operator()(const StiffnessRegion& region) const {
        add_points(digest, region.points);
        digest.add(region.value);
    }
    void operator()(const StiffnessPicture& picture) const {
        digest.add(picture.max);
        digest.add(picture.width_px);
        digest.add(picture.height_px);
        digest.add(picture.grey.rows);
        digest.add(picture.grey.cols);
        for (int row = 0; row < picture.grey.rows; ++row) {
            digest.add(picture.grey.ptr(row), picture.grey.elemSize() * static_cast<std::size_t>(picture.grey.cols));
        }
    }
};

std::string key_of(const TriangleMesh& mesh, const Rig& rig, const WeightOptions& options) {
    Digest digest;
    digest.add(revision);
    digest.add(static_cast<int>(options.kind));
    digest.add(static_cast<int>(options.partition));
    digest.add(options.tolerance);
    digest.add(options.max_iterations);
    digest.add(options.l1_budget);
    digest.add_matrix(mesh.V);
    digest.add_matrix(mesh.F);
    digest.add(rig.handles.size());
    for (const Handle& handle : rig.handles) {
        digest.add(handle.shape.index());
        std::visit(AddShape{digest}, handle.shape);
        digest.add(handle.id);  // warnings name handles
    }
    for (const Stiffness& stiffness : rig.stiffness) {
        digest.add(stiffness.index());
        std::visit(AddStiffness{digest}, stiffness);
    }
    return digest.text();
}

Json bytes_of(const Eigen::MatrixXd& matrix) {
    std::vector<std::uint8_t> bytes(sizeof(double) * static_cast<std::size_t>(matrix.size()));
    if (!bytes.empty()) std::memcpy(bytes.data(), matrix.data(), bytes.size());
    return Json::binary(std::move(bytes));
}

// \return none when the bytes are not of this size.
std::optional<Eigen::MatrixXd> matrix_of(const Json& json, Eigen::Index rows, Eigen::Index cols) {
    const auto& bytes = json.get_binary();
    if (bytes.size() != sizeof(double) * static_cast<std::size_t>(rows * cols)) return std::nullopt;
    Eigen::MatrixXd matrix(rows, cols);
    if (!bytes.empty()) std::memcpy(matrix.data(), bytes.data(), bytes.size());
    return matrix;
}

std::string payload_of(const Weights& weights) {
    Json json;
    json["W"] = bytes_of(weights.W);
    json["iterations"] = weights.iterations;
    json["converged"] = weights.converged;
    json["kkt_residual"] = weights.kkt_residual;
    json["partition_error"] = weights.partition_error;
    json["fallback"] = weights.fallback;
    json["warnings"] = weights.warnings;
    json["columns"] = Json::array();
    for (const WeightColumn& column : weights.columns) json["columns"].push_back({column.handle, column.corner});
    std::string bytes;
    Json::to_cbor(json, nlohmann::detail::output_adapter<char>(bytes));
    return bytes;
}

// \param vertices  of the mesh.
std::optional<Weights> weights_of(const std::string& payload, Eigen::Index vertices) {
    const Json json = Json::from_cbor(payload);
    Weights weights;
    for (const Json& column : json.at("columns")) {
        weights.columns.push_back({column.at(0).get<int>(), column.at(1).get<int>()});
    }
    const auto W = matrix_of(json.at("W"), vertices, static_cast<Eigen::Index>(weights.columns.size()));
    if (!W) return std::nullopt;
    weights.W = *W;
    weights.iterations = json.at("iterations").get<int>();
    weights.converged = json.at("converged").get<bool>();
    weights.kkt_residual = json.at("kkt_residual").get<double>();
    weights.partition_error = json.at("partition_error").get<double>();
    weights.fallback = json.at("fallback").get<std::string>();
    weights.warnings = json.at("warnings").get<std::vector<std::string>>();
    return weights;
}

std::string digest_of(const std::string& bytes) {
    Digest digest;
    digest.add(bytes.data(), bytes.size());
    return digest.text();
}

std::optional<Weights> kept_weights(const std::filesystem::path& file, const std::string& key,
                                    const TriangleMesh& mesh) {
    try {
        const std::string text = read_file(file, largest_file);
        const std::string head = format_line + key;
        if (text.compare(0, head.size(), head) != 0 || text.size() < head.size() + digest_length) return std::nullopt;
        const std::string payload = text.substr(head.size() + digest_length);
        if (text.compare(head.size(), digest_length, digest_of(payload)) != 0) return std::nullopt;
        return weights_of(payload, mesh.V.rows());
    } catch (const Error&) {
        return std::nullopt;
    } catch (const Json::exception&) {
        return std::nullopt;
    }
}

void keep(const Weights& weights, const std::filesystem::path& file, const std::string& key) {
    if (sizeof(double) * static_cast<std::size_t>(weights.W.size()) > largest_file / 2) return;
    try {
        const std::string payload = payload_of(weights);
        write_file(file, format_line + key + digest_of(payload) + payload);
    } catch (const Error&) {
        // A folder that cannot be written: the next run computes them again.
    }
}

bool takes_long(WeightKind kind) {
    return kind == WeightKind::bbw || kind == WeightKind::l1 || kind == WeightKind::monotonic;
}

}  // namespace

std::filesystem::path weights_cache_path(const std::filesystem::path& puppet_file) {
    return std::filesystem::path(puppet_file).replace_extension(".weights");
}

Weights cached_weights(const TriangleMesh& mesh, const Rig& rig, const WeightOptions& options,
                       const std::filesystem::path& file, Progress& progress) {
    if (file.empty() || !takes_long(options.kind)) return compute_weights(mesh, rig, options, progress);
    require_sound(mesh, "mesh");
    require_sound(rig);
    const std::string key = key_of(mesh, rig, options);
    if (std::optional<Weights> kept = kept_weights(file, key, mesh)) return *std::move(kept);
    Weights weights = compute_weights(mesh, rig, options, progress);
    keep(weights, file, key);
    return weights;
}

}  // namespace puppetwarp
