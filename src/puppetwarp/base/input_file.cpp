#include <puppetwarp/base/input_file.h>

#include <puppetwarp/base/errors.h>

#include <cerrno>
#include <cstring>
#include <fstream>

#include <unistd.h>

namespace puppetwarp {

namespace fs = std::filesystem;

void require_readable_file(const fs::path& path) {
    const std::string subject = path.empty() ? "input" : path.string();
    if (path.empty()) throw InvalidInput(subject, "the file name is empty");
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (status.type() == fs::file_type::not_found) throw InvalidInput(subject, "no such file", "check the path");
    if (error) throw InvalidInput(subject, error.message());
    if (fs::is_directory(status)) throw InvalidInput(subject, "is a folder", "name a file in it");
    if (!fs::is_regular_file(status)) throw InvalidInput(subject, "is not a regular file", "copy it into a file first");
    if (::access(path.c_str(), R_OK) != 0) throw InvalidInput(subject, std::strerror(errno), "check its permissions");
    const auto size = fs::file_size(path, error);
    if (error) throw InvalidInput(subject, error.message());
    if (size == 0) throw InvalidInput(subject, "the file is empty");
}

std::string read_file(const fs::path& path, std::size_t max_bytes) {
    require_readable_file(path);
    if (fs::file_size(path) > max_bytes) {
        throw InvalidInput(path.string(), "is larger than " + std::to_string(max_bytes >> 20) + " MB",
                           "is it the right file?");
    }
    std::ifstream stream(path, std::ios::binary);
    std::string text{std::istreambuf_iterator<char>(stream), {}};
    if (stream.bad() || text.empty()) throw InvalidInput(path.string(), "cannot be read");
    return text;
}

}  // namespace puppetwarp
