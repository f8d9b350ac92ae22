#include <puppetwarp/image/picture_file.h>

#include <puppetwarp/base/errors.h>
#include <puppetwarp/base/input_file.h>

#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace puppetwarp {

PictureFile::PictureFile(const std::filesystem::path& path) : path_(path) {
    require_readable_file(path);
    // Something else may have taken the name meanwhile: O_NONBLOCK keeps a pipe from holding us, and the open file
    // counts.
    descriptor_ = ::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    if (descriptor_ < 0) {
        const int error = errno;
        if (error == EMFILE || error == ENFILE || error == ENOMEM)
            throw MachineFault(name(), std::string("cannot be opened: ") + std::strerror(error));
        throw InvalidInput(name(), std::string("cannot be opened: ") + std::strerror(error));
    }
    struct stat status {};
    signature_.resize(16);
    const bool regular = ::fstat(descriptor_, &status) == 0 && S_ISREG(status.st_mode);
    const ssize_t count = regular ? ::pread(descriptor_, signature_.data(), signature_.size(), 0) : -1;
    if (count <= 0) {
        ::close(descriptor_);
        throw InvalidInput(name(), "cannot be read");
    }
    signature_.resize(static_cast<std::size_t>(count));
    size_bytes_ = static_cast<std::uint64_t>(status.st_size);
}

PictureFile::~PictureFile() {
    ::close(descriptor_);
}

}  // namespace puppetwarp
