#include <puppetwarp/project/rendered_files.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/mesh/mesh_file.h>

#include <algorithm>
#include <cctype>
#include <string>

namespace puppetwarp {

namespace {

std::string extension_of(const std::filesystem::path& path) {
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return extension;
}

}  // namespace

DisplacementRows displacement_of(const Rendered& rendered, const RenderOptions& options) {
    const auto at = [&](const Eigen::MatrixX2d& V, double scale) -> Eigen::MatrixX2d {
        return (V.array().rowwise() * rendered.resolution.array()) * scale;
    };
    return {rendered.source,
            rendered.matte,
            {at(rendered.mesh.V, 1), rendered.mesh.F},
            at(rendered.moved, rendered.scale),
            {options.interpolation, rendered.report.canvas, false, {}, rendered.back_faces, rendered.depth},
            rendered.scale};
}

void require_moved_mesh_name(const std::filesystem::path& path) {
    const std::string extension = extension_of(path);
    if (extension != ".off" && extension != ".obj" && extension != ".svg")
        throw InvalidInput(path.string(), "the extension says no format of a moved mesh", "use .off, .obj or .svg");
}

void write_moved_mesh(const Rendered& rendered, const std::filesystem::path& path) {
    require_moved_mesh_name(path);
    const TriangleMesh moved{rendered.moved, rendered.mesh.F};
    if (extension_of(path) != ".svg") {
        const Eigen::RowVector2d size =
            Eigen::RowVector2d(rendered.source.width(), rendered.source.height()).cwiseQuotient(rendered.resolution);
        write_mesh(moved, path, texture_coordinates(rendered.mesh.V, size.x(), size.y()));
        return;
    }
    const double scale = rendered.report.scale;
    const Canvas& canvas = rendered.report.canvas;
    write_mesh_svg(moved, {canvas.x / scale, canvas.y / scale, canvas.width / scale, canvas.height / scale, scale},
                   path);
}

}  // namespace puppetwarp
