#include <puppetwarp/mesh/mesh_file.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/base/input_file.h>
#include <puppetwarp/base/output_file.h>
#include <puppetwarp/mesh/mesh_text.h>

#include <algorithm>
#include <cctype>
#include <string>

namespace puppetwarp {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t largest_file = std::size_t{1} << 30;

std::string extension_of(const fs::path& path) {
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return extension;
}

[[noreturn]] void refuse_extension(const fs::path& path) {
    throw InvalidInput(path.string(), "its extension names no mesh format", "use .off or .obj");
}

}  // namespace

TriangleMesh read_mesh(const fs::path& path) {
    const std::string extension = extension_of(path);
    if (extension != ".off" && extension != ".obj") refuse_extension(path);
    const std::string text = read_file(path, largest_file);
    const std::string subject = path.string();
    TriangleMesh mesh = extension == ".off" ? mesh_from_off(text, subject) : mesh_from_obj(text, subject);
    require_sound(mesh, subject.c_str());
    return mesh;
}

void write_mesh(const TriangleMesh& mesh, const fs::path& path, const Eigen::MatrixX2d& texture) {
    const std::string extension = extension_of(path);
    if (extension != ".off" && extension != ".obj") refuse_extension(path);
    if (texture.rows() != 0 && texture.rows() != mesh.V.rows()) {
        throw InvalidInput("texture coordinates", "there are " + std::to_string(texture.rows()) + " for a mesh of " +
                                                      std::to_string(mesh.V.rows()) + " vertices");
    }
    write_file(path, extension == ".off" ? off_from_mesh(mesh) : obj_from_mesh(mesh, texture));
}

Eigen::MatrixX2d texture_coordinates(const Eigen::MatrixX2d& V, double width, double height) {
    Eigen::MatrixX2d texture(V.rows(), 2);
    texture.col(0) = V.col(0) / width;
    texture.col(1) = 1 - V.col(1).array() / height;
    return texture;
}

void write_mesh_svg(const TriangleMesh& mesh, const DrawingArea& area, const fs::path& path) {
    write_file(path, svg_from_mesh(mesh, area));
}

}  // namespace puppetwarp
