#include <puppetwarp/base/errors.h>
#include <puppetwarp/base/stage_timer.h>
#include <puppetwarp/project/pipeline.h>
#include <puppetwarp/project/result_picture.h>
#include <puppetwarp/project/source_picture.h>
#include <puppetwarp/warp/displacement_file.h>

#include <cstdio>
#include <string>

namespace puppetwarp {

namespace {

// Maps whose numbers are rounded to more make a smooth picture ripple.
constexpr double coarsest_map_px = 1.0 / 16;

// Pixels of a result through a map.
struct MapScales {
    Eigen::Array2d map;  // for one of the map
    double picture;      // for one of the picture
};

MapScales scales_of(const StoredDisplacement& stored, const ImageInfo& picture, const std::filesystem::path& map_file,
                    const RenderOptions& options) {
    const DisplacementPlane& plane = stored.map.plane;
    const SourceSize size{picture.width, picture.height, plane.source_width, plane.source_height};
    if (!size.is_same_shape()) {
        throw InvalidInput(map_file.string(),
                           "was made for a picture of " + std::to_string(plane.source_width) + " x " +
                               std::to_string(plane.source_height) + " pixels, and this one has " +
                               std::to_string(picture.width) + " x " + std::to_string(picture.height),
                           "give that picture, at any resolution");
    }
    return {size.resolution().transpose().array() * options.scale, plane.scale * options.scale};
}

Canvas canvas_through(const DisplacementPlane& plane, const MapScales& scales, const ImageInfo& picture,
                      const RenderOptions& options) {
    if (options.canvas.kind == CanvasChoice::Kind::given)
        return scaled_canvas(options.canvas.canvas, scales.picture, scales.picture);
    const Canvas all = scaled_canvas(plane.canvas, scales.map.x(), scales.map.y());
    if (options.canvas.kind == CanvasChoice::Kind::of_map) return all;
    const Canvas own = scaled_canvas({0, 0, picture.width, picture.height}, scales.picture, scales.picture);
    if (options.canvas.kind == CanvasChoice::Kind::keep) return own;
    Eigen::MatrixX2d corners(2, 2);
    corners << all.x, all.y, static_cast<double>(all.x) + all.width, static_cast<double>(all.y) + all.height;
    return grown_canvas(own.width, own.height, corners);
}

}  // namespace

Rendered render_through(const std::filesystem::path& picture, const std::filesystem::path& map_file,
                        const std::string& background, const RenderOptions& options, Progress& progress) {
    require_scale(options.scale);
    Rendered rendered;
    RenderReport& report = rendered.report;
    StageTimer timer(report.timings_ms);
    progress.step("read", 0);
    const ImageInfo info = read_image_info(picture, options.read);
    const StoredDisplacement stored = read_displacement(map_file, info.width, info.height, options.read);
    const MapScales scales = scales_of(stored, info, map_file, options);
    report.canvas = canvas_through(stored.map.plane, scales, info, options);
    require_result_size(report.canvas, options.read.max_pixels);
    if (stored.map.rounding_px > coarsest_map_px) {
        char text[64];
        std::snprintf(text, sizeof(text), ": its numbers are rounded to %.2g px (use 32-bit floats)",
                      stored.map.rounding_px);
        report.warnings.push_back(map_file.string() + text);
    }
    const Image image = read_image(picture, options.read);
    timer.end("read");

    RenderOptions drawing = options;
    drawing.scale = report.scale = scales.picture;
    const Image warped =
        warp_through(image, stored.map,
                     {options.interpolation, scales.map.x(), scales.map.y(), report.canvas, options.linear}, progress);
    take_result(finished_picture({rows_of(warped), std::nullopt}, image, cut_out(image),
                                 background_from_name(background), drawing, report, progress),
                options, rendered);
    timer.end("warp");
    return rendered;
}

}  // namespace puppetwarp
