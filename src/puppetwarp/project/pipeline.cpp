#include <puppetwarp/project/pipeline.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/base/stage_timer.h>
#include <puppetwarp/cutout/edge_colours.h>
#include <puppetwarp/mesh/triangulate.h>
#include <puppetwarp/project/result_picture.h>
#include <puppetwarp/project/source_picture.h>
#include <puppetwarp/project/stiffness_pictures.h>
#include <puppetwarp/project/weights_cache.h>
#include <puppetwarp/rig/add_cage.h>
#include <puppetwarp/rig/depth.h>
#include <puppetwarp/rig/inverse_kinematics.h>
#include <puppetwarp/rig/snap.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <future>
#include <optional>
#include <string_view>
#include <utility>

namespace puppetwarp {

namespace {

// Fewer pixels than a cubic filter has taps hold nothing that could be bent.
constexpr int smallest_side_px = 4;

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

// \param moved  in pixels of the result.
Canvas choose_canvas(const CanvasChoice& choice, int width, int height, const Eigen::MatrixX2d& moved, double scale) {
    if (choice.kind == CanvasChoice::Kind::given) return scaled_canvas(choice.canvas, scale, scale);
    const Canvas own = scaled_canvas({0, 0, width, height}, scale, scale);
    return choice.kind == CanvasChoice::Kind::keep ? own : grown_canvas(own.width, own.height, moved);
}

// What the chosen canvas was rounded from.
Eigen::AlignedBox2d choose_frame(const RenderOptions& options, const Image& image, const Eigen::MatrixX2d& moved) {
    if (options.canvas.kind == CanvasChoice::Kind::given) return scaled_frame(options.canvas.canvas, options.scale);
    Eigen::AlignedBox2d frame = scaled_frame({0, 0, image.width(), image.height()}, options.scale);
    if (options.canvas.kind == CanvasChoice::Kind::keep || moved.rows() == 0) return frame;
    return frame.extend(Eigen::AlignedBox2d(moved.colwise().minCoeff(), moved.colwise().maxCoeff()));
}

// The choice in pixels of a picture of another resolution.
CanvasChoice at_resolution(const CanvasChoice& choice, const Eigen::RowVector2d& resolution) {
    if (choice.kind != CanvasChoice::Kind::given) return choice;
    return {choice.kind, scaled_canvas(choice.canvas, resolution.x(), resolution.y())};
}

// What headers tell, before any work: sizes, and whether the canvas is possible as far as no moved position decides.
// Nothing is read, and no size told, where there is nothing to learn.
std::optional<SourceSize> size_before_work(const Puppet& puppet, const RenderOptions& options) {
    require_scale(options.scale);
    const bool given = options.canvas.kind == CanvasChoice::Kind::given;
    std::optional<SourceSize> size;
    if (!options.image.empty() || (options.scale != 1 && !given))
        size = source_size(puppet, options.image, options.read);
    if (!size && !given) return size;
    // A grown canvas holds the picture's own.
    const CanvasChoice least = !given ? CanvasChoice{}
                               : size ? at_resolution(options.canvas, size->resolution())
                                      : options.canvas;
    require_result_size(choose_canvas(least, size ? size->width : 0, size ? size->height : 0, {}, options.scale),
                        options.read.max_pixels);
    return size;
}

// Positions in pixels of a picture of another resolution.
Eigen::MatrixX2d at(const Eigen::RowVector2d& resolution, const Eigen::MatrixX2d& V) {
    return V.array().rowwise() * resolution.array();
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
    if (options.automatic_cage > 0) add_automatic_cage(solved.rig, outline, options.automatic_cage);
    const std::unique_ptr<Deformer> deformer =
        bound_deformer(puppet.method, solved.mesh, solved.rig, options.weights_cache, progress);
    timer.end("bind");
    Deformation deformation = deformer->deform(pose, nullptr, progress);
    solved.depth = vertex_depths(solved.mesh, solved.rig, pose);
    timer.end("deform");

    describe(puppet.method, solved.mesh, solved.rig, pose, deformation, report);
    solved.moved = std::move(deformation.V);
    return solved;
}

// What is drawn, and how it was moved.
struct Subject {
    Image image;
    SourceSize size;
    Cutout cutout;
    Solved solved;
};

// The progress of work beside the reading of its picture: cancelled when that has failed, for nothing will be drawn.
class WhileReading : public Progress {
public:
    WhileReading(Progress& progress, const std::atomic<bool>& failed) : progress_(progress), failed_(failed) {}
    bool cancelled() const override { return failed_ || progress_.cancelled(); }

protected:
    void show(std::string_view stage, double fraction) override { progress_.step(stage, fraction); }

private:
    Progress& progress_;
    const std::atomic<bool>& failed_;
};

Subject solved_subject(const Puppet& puppet, const Pose& pose, const RenderOptions& options, RenderReport& report,
                       Progress& progress) {
    const std::optional<SourceSize> told = size_before_work(puppet, options);
    const std::optional<SourceSize> whole = size_of_whole(puppet, options.image, options.read);
    std::atomic<bool> failed = false;
    std::future<Image> reading = std::async(std::launch::async, [&] {
        try {
            return options.image.empty() ? load_image(puppet, options.read) : load_image(options.image, options.read);
        } catch (...) {
            failed = true;
            throw;
        }
    });
    Subject subject;
    WhileReading while_reading(progress, failed);
    const auto solve_for = [&](const SourceSize& size, const Cutout& cutout) {
        subject.solved = solve(puppet, pose, size.rig_width, size.rig_height, cutout, options, report, while_reading);
    };
    // The mesh of a whole picture is that of its rectangle: it is made and moved while the pixels are decoded.
    const bool meanwhile = whole && std::min(whole->width, whole->height) >= smallest_side_px;
    if (meanwhile) {
        try {
            solve_for(*whole, {true, {}});
        } catch (const Cancelled&) {
            if (failed) reading.get();
            throw;
        }
    }
    StageTimer timer(report.timings_ms);
    subject.image = reading.get();
    timer.end("read");
    const int width = subject.image.width(), height = subject.image.height();
    subject.size = told.value_or(SourceSize{width, height, width, height});
    subject.cutout = cut_out_at(subject.size, puppet, subject.image, options.read);
    if (!meanwhile) solve_for(subject.size, cutout_for_rig(subject.cutout, subject.size));
    return subject;
}

}  // namespace

std::unique_ptr<Deformer> bound_deformer(const MethodOptions& method, const TriangleMesh& mesh, const Rig& rig,
                                         const std::filesystem::path& weights_cache, Progress& progress) {
    if (!uses_weights(method.method)) return make_deformer(method, mesh, rig, progress);
    return make_deformer(method, mesh, rig, cached_weights(mesh, rig, method.weights, weights_cache, progress));
}

void describe(const MethodOptions& method, const TriangleMesh& mesh, const Rig& rig, const Pose& pose,
              const Deformation& deformation, RenderReport& report) {
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
    for (std::string& missed : reach_warnings(rig, pose)) report.warnings.push_back(std::move(missed));
    report.max_handle_error_px = deformation.max_handle_error_px;
    report.distortion = measure_distortion(mesh, deformation.V);
}

Image load_image(const Puppet& puppet, const ReadOptions& options) {
    if (puppet.image.empty()) throw InvalidInput("puppet", "names no picture", "add the field `image`");
    return load_image(resolve(puppet, puppet.image), options);
}

Image load_image(const std::filesystem::path& path, const ReadOptions& options) {
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
    return cut_out(image, cutout_options(puppet, read));
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
    return kept ? apply_cutout(image, cutout) : apply_clean_cutout(image, cutout);
}

PictureRows draw_subject_rows(const Puppet& puppet, Image image, const Cutout& cutout, const TriangleMesh& mesh,
                              const Eigen::MatrixX2d& moved, const Eigen::VectorXd& depth, const RenderOptions& options,
                              RenderReport& report, Progress& progress) {
    const Eigen::MatrixX2d shown = moved * options.scale;
    report.scale = options.scale;
    report.max_magnification = largest_magnification(mesh, shown);
    report.canvas = choose_canvas(options.canvas, image.width(), image.height(), shown, options.scale);
    require_result_size(report.canvas, options.read.max_pixels);
    const WarpOptions how{options.interpolation, report.canvas, options.linear, choose_frame(options, image, shown),
                          puppet.back_faces,     depth};
    const Background background = background_from_name(puppet.background.value_or("transparent"));
    const WarpedRows warped = warp_rows(cut_subject(image, cutout, background), mesh, shown, how, progress);
    return finished_picture(warped, std::move(image), cutout, background, options, report, progress);
}

Image draw_subject(const Puppet& puppet, const Image& image, const Cutout& cutout, const TriangleMesh& mesh,
                   const Eigen::MatrixX2d& moved, const Eigen::VectorXd& depth, const RenderOptions& options,
                   RenderReport& report, Progress& progress) {
    return whole_picture(draw_subject_rows(puppet, image, cutout, mesh, moved, depth, options, report, progress));
}

Rendered render(const Puppet& puppet, const Pose& pose, const RenderOptions& options, Progress& progress) {
    if (puppet.rig.handles.empty() && options.automatic_cage == 0) {
        throw InvalidInput("puppet", "has no pins and no handles", "add --pin X,Y or handles to the puppet file");
    }
    Rendered rendered;
    RenderReport& report = rendered.report;
    progress.step("read", 0);
    auto [image, size, cutout, solved] = solved_subject(puppet, pose, options, report, progress);
    StageTimer warp_timer(report.timings_ms);
    const Eigen::RowVector2d resolution = size.resolution();
    RenderOptions drawing = options;
    drawing.canvas = at_resolution(options.canvas, resolution);
    if (options.keep_source) {
        rendered.source = apply_cutout(image, cutout);
        if (rendered.source.pixels.data != image.pixels.data) rendered.matte = cutout.matte;
    }
    const PictureRows result =
        draw_subject_rows(puppet, std::move(image), cutout, {at(resolution, solved.mesh.V), solved.mesh.F},
                          at(resolution, solved.moved), solved.depth, drawing, report, progress);
    take_result(result, options, rendered);
    report.scale *= resolution.x();
    warp_timer.end("warp");
    rendered.mesh = std::move(solved.mesh);
    rendered.moved = std::move(solved.moved);
    rendered.depth = std::move(solved.depth);
    rendered.back_faces = puppet.back_faces;
    rendered.rig = std::move(solved.rig);
    rendered.resolution = resolution;
    rendered.scale = options.scale;
    return rendered;
}

}  // namespace puppetwarp
