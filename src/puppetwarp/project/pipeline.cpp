#include <puppetwarp/project/pipeline.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/cutout/edge_colours.h>
#include <puppetwarp/cutout/fill_behind.h>
#include <puppetwarp/image/write.h>
#include <puppetwarp/mesh/triangulate.h>
#include <puppetwarp/project/stage_timer.h>
#include <puppetwarp/project/stiffness_pictures.h>
#include <puppetwarp/project/weights_cache.h>
#include <puppetwarp/rig/depth.h>
#include <puppetwarp/rig/snap.h>

#include <algorithm>
#include <chrono>
#include <cmath>

namespace puppetwarp {

namespace {

// Fewer pixels than a cubic filter has taps hold nothing that could be bent.
constexpr int smallest_side_px = 4;

// Measures stages one after the other into a report.
CutoutSource source_from_name(const std::string& name) {
    if (name == "auto") return CutoutSource::automatic;
    if (name == "alpha") return CutoutSource::alpha;
    if (name == "mask") return CutoutSource::mask;
    if (name == "polygon") return CutoutSource::polygon;
    if (name == "whole") return CutoutSource::whole;
    throw InvalidInput("cutout '" + name + "'", "is unknown", "use auto, alpha, mask, polygon or whole");
}

TriangulationOptions triangulation_options(const Puppet& puppet, const Outline& outline) {
    TriangulationOptions options;
    options.max_edge_px = puppet.mesh.max_edge_px.value_or(default_max_edge_px(outline));
    options.min_angle_deg = puppet.mesh.min_angle_deg.value_or(options.min_angle_deg);
    return options;
}

// A hole that no triangle fits into would only cost small triangles around it.
void fill_small_holes(Outline& outline, double max_edge_px) {
    const double triangle_area = std::sqrt(3.0) / 4 * max_edge_px * max_edge_px;
    for (OutlineComponent& component : outline.components) {
        std::erase_if(component.holes, [&](const Polyline& hole) { return -signed_area(hole) < triangle_area; });
    }
}

// Where bones and cage edges run, the mesh has edges: a bone bends the picture along itself.
// \param points  whether points become vertices, which weights hold.
std::vector<Polyline> mesh_constraints(const Rig& rig, bool points) {
    std::vector<Polyline> constraints;
    for (const Handle& handle : rig.handles) {
        const auto* point = std::get_if<PointHandle>(&handle.shape);
        if (point != nullptr && points) constraints.push_back({point->at});
        if (const auto* bone = std::get_if<BoneHandle>(&handle.shape)) {
            constraints.push_back({bone->from, bone->to});
        } else if (const auto* cage = std::get_if<CageHandle>(&handle.shape)) {
            constraints.push_back(cage->points);
            constraints.back().push_back(cage->points.front());
        }
    }
    return constraints;
}

Canvas choose_canvas(const CanvasChoice& choice, const Image& image, const Eigen::MatrixX2d& moved) {
    switch (choice.kind) {
        case CanvasChoice::Kind::keep: return {0, 0, image.width(), image.height()};
        case CanvasChoice::Kind::grow: return grown_canvas(image.width(), image.height(), moved);
        case CanvasChoice::Kind::given: break;
    }
    return choice.canvas;
}

void require_size(const Canvas& canvas, std::int64_t max_pixels) {
    const std::int64_t pixels = std::int64_t{canvas.width} * canvas.height;
    if (pixels > max_pixels) {
        throw InvalidInput("canvas",
                           "would have " + std::to_string(canvas.width) + " x " + std::to_string(canvas.height) +
                               " pixels, more than " + std::to_string(max_pixels),
                           "raise --max-pixels or choose a smaller --canvas");
    }
}

// Positions of the puppet's mesh in a pose, and what the report says of them.
struct Solved {
    TriangleMesh mesh;
    Eigen::MatrixX2d moved;
    Eigen::VectorXd depth;
    Rig rig;
};

Solved solve(const Puppet& puppet, const Pose& pose, int width, int height, const Cutout& cutout,
             const RenderOptions& options, RenderReport& report, Progress& progress) {
    StageTimer timer(report.timings_ms);
    const Outline outline = outline_subject(puppet, width, height, cutout);
    timer.end("cutout");
    Solved solved;
    solved.mesh = mesh_subject(puppet, outline);
    timer.end("triangulate");
    solved.rig = snapped(load_rig(puppet, width, height, options.read), solved.mesh, options.pin_snap_px);
    const std::unique_ptr<Deformer> deformer =
        bound_deformer(puppet.method, solved.mesh, solved.rig, options.weights_cache, progress);
    timer.end("bind");
    Deformation deformation = deformer->deform(pose, nullptr, progress);
    solved.depth = vertex_depths(solved.mesh, solved.rig, pose);
    timer.end("deform");

    describe(puppet.method, solved.mesh, puppet.rig, deformation, report);
    solved.moved = std::move(deformation.V);
    return solved;
}

}  // namespace

std::unique_ptr<Deformer> bound_deformer(const MethodOptions& method, const TriangleMesh& mesh, const Rig& rig,
                                         const std::filesystem::path& weights_cache, Progress& progress) {
    if (!uses_weights(method.method)) return make_deformer(method, mesh, rig, progress);
    return make_deformer(method, mesh, rig, cached_weights(mesh, rig, method.weights, weights_cache, progress));
}

void describe(const MethodOptions& method, const TriangleMesh& mesh, const Rig& rig, const Deformation& deformation,
              RenderReport& report) {
    if (!deformation.V.allFinite()) {
        throw InvalidInput("mesh", "its triangles are too thin or too different in size to compute with",
                           "use a mesh with better triangles");
    }
    report.method = method_name(method.method);
    report.vertices = static_cast<int>(mesh.V.rows());
    report.triangles = static_cast<int>(mesh.F.rows());
    report.handles = static_cast<int>(rig.handles.size());
    report.iterations = deformation.iterations;
    report.converged = deformation.converged;
    report.energy = deformation.energy;
    report.energy_history = deformation.energy_history;
    report.warnings = deformation.warnings;
    report.max_handle_error_px = deformation.max_handle_error_px;
    report.distortion = measure_distortion(mesh, deformation.V);
}

Image load_image(const Puppet& puppet, const ReadOptions& options) {
    if (puppet.image.empty()) throw InvalidInput("puppet", "names no picture", "add the field `image`");
    const std::filesystem::path path = resolve(puppet, puppet.image);
    Image image = read_image(path, options);
    if (std::min(image.width(), image.height()) < smallest_side_px) {
        throw InvalidInput(path.string(),
                           "a picture of " + std::to_string(image.width()) + " x " + std::to_string(image.height()) +
                               " pixels is too small to be warped",
                           "both sides must have at least " + std::to_string(smallest_side_px));
    }
    return image;
}

Cutout cut_out_subject(const Puppet& puppet, const Image& image, const ReadOptions& read) {
    CutoutOptions options;
    options.from = source_from_name(puppet.cutout.from);
    options.points = puppet.cutout.points;
    options.holes = puppet.cutout.holes;
    if (options.from == CutoutSource::mask) options.mask = read_image(resolve(puppet, puppet.cutout.path), read);
    return cut_out(image, options);
}

Outline outline_subject(const Puppet& puppet, int width, int height, const Cutout& cutout) {
    if (cutout.whole) return rectangle_outline(width, height);
    OutlineOptions options;
    options.expand_px = puppet.mesh.expand_px.value_or(options.expand_px);
    Outline outline = trace_outline(cutout.matte, options);
    fill_small_holes(outline, triangulation_options(puppet, outline).max_edge_px);
    return outline;
}

TriangleMesh mesh_subject(const Puppet& puppet, const Outline& outline) {
    if (uses_weights(puppet.method.method)) return mesh_for_weights(puppet, outline);
    return triangulate(outline, mesh_constraints(puppet.rig, false), triangulation_options(puppet, outline));
}

TriangleMesh mesh_for_weights(const Puppet& puppet, const Outline& outline) {
    return triangulate(outline, mesh_constraints(puppet.rig, true), triangulation_options(puppet, outline));
}

Image cut_subject(const Image& image, const Cutout& cutout, const Background& background) {
    const bool kept = background.kind == Background::Kind::keep;
    return apply_cutout(kept ? image : with_clean_edges(image, cutout), cutout);
}

Image draw_subject(const Puppet& puppet, const Image& image, const Cutout& cutout, const TriangleMesh& mesh,
                   const Eigen::MatrixX2d& moved, const Eigen::VectorXd& depth, const RenderOptions& options,
                   RenderReport& report, Progress& progress) {
    report.canvas = choose_canvas(options.canvas, image, moved);
    require_size(report.canvas, options.read.max_pixels);
    const WarpOptions how{options.interpolation, report.canvas, puppet.back_faces, depth};
    const Background background = background_from_name(puppet.background.value_or("transparent"));
    const Image warped = warp(cut_subject(image, cutout, background), mesh, moved, how, progress);
    const bool filled = background.kind == Background::Kind::inpaint;
    Image result = lay_over(background, warped, filled ? fill_behind(image, cutout, progress) : image, report.canvas);
    if (options.format.empty()) return result;

    report.lost = lost_in_format(result, options.format);
    if (result.has_alpha() && !format_holds_alpha(options.format)) {
        const Background opaque{cutout.whole ? Background::Kind::keep : Background::Kind::colour, {1, 1, 1, 1}};
        result = lay_over(opaque, result, image, report.canvas);
    }
    return result;
}

Rendered render(const Puppet& puppet, const Pose& pose, const RenderOptions& options, Progress& progress) {
    if (puppet.rig.handles.empty()) {
        throw InvalidInput("puppet", "has no pins and no handles", "add --pin X,Y or handles to the puppet file");
    }
    Rendered rendered;
    RenderReport& report = rendered.report;
    StageTimer timer(report.timings_ms);
    progress.step("read", 0);
    const Image image = load_image(puppet, options.read);
    timer.end("read");
    const Cutout cutout = cut_out_subject(puppet, image, options.read);
    Solved solved = solve(puppet, pose, image.width(), image.height(), cutout, options, report, progress);
    StageTimer warp_timer(report.timings_ms);
    rendered.image =
        draw_subject(puppet, image, cutout, solved.mesh, solved.moved, solved.depth, options, report, progress);
    warp_timer.end("warp");
    rendered.mesh = std::move(solved.mesh);
    rendered.moved = std::move(solved.moved);
    rendered.depth = std::move(solved.depth);
    rendered.rig = std::move(solved.rig);
    return rendered;
}

}  // namespace puppetwarp
