#include <puppetwarp/mesh/mesh_file.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/base/output_file.h>
#include <puppetwarp/mesh/mesh_text.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <string>

namespace puppetwarp {

namespace fs = std::filesystem;

namespace {

std::string extension_of(const fs::path& path) {
    std::string extension = path.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return extension;
}

[[noreturn]] void refuse_extension(const fs::path& path) {
    throw InvalidInput(path.string(), "its extension names no mesh format", "use .off or .obj");
}

// The path is looked at first: opening a pipe would wait for ever.
std::string file_text(const fs::path& path) {
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (!fs::exists(status)) throw InvalidInput(path.string(), "the file does not exist");
    if (!fs::is_regular_file(status)) throw InvalidInput(path.string(), "it is not a regular file");
    std::ifstream file(path, std::ios::binary);
    if (!file) throw InvalidInput(path.string(), "it cannot be opened for reading");
    std::string text(fs::file_size(path), '\0');
    file.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<std::size_t>(file.gcount()));
    if (text.empty()) throw InvalidInput(path.string(), "the file is empty");
    return text;
}

}  // namespace

TriangleMesh read_mesh(const fs::path& path) {
    const std::string extension = extension_of(path);
    if (extension != ".off" && extension != ".obj") refuse_extension(path);
    const std::string text = file_text(path);
    const std::string subject = path.string();
    const TriangleMesh mesh = extension == ".off" ? mesh_from_off(text, subject) : mesh_from_obj(text, subject);
    require_sound(mesh, subject.c_str());
    return mesh;
}

void write_mesh(const TriangleMesh& mesh, const fs::path& path) {
    const std::string extension = extension_of(path);
    if (extension != ".off" && extension != ".obj") refuse_extension(path);
    write_file(path, extension == ".off" ? off_from_mesh(mesh) : obj_from_mesh(mesh));
}

void write_mesh_svg(const TriangleMesh& mesh, int width, int height, const fs::path& path) {
    write_file(path, svg_from_mesh(mesh, width, height));
}

}  // namespace puppetwarp
