#include <puppetwarp/base/output_file.h>

#include <puppetwarp/base/errors.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <climits>
#include <cstdlib>
#include <cstring>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace puppetwarp {

namespace fs = std::filesystem;

namespace {

// Names of the temporary files that are open now, for a signal handler to remove: plain memory and atomics, because
// a handler may neither lock nor allocate. A slot is claimed, filled, then published.
struct TemporaryName {
    std::atomic<bool> claimed{false};
    std::atomic<bool> published{false};
    std::array<char, PATH_MAX> path{};
};
std::array<TemporaryName, 16> temporary_names;

int publish(const std::string& path) {
    if (path.size() >= PATH_MAX) return -1;
    for (std::size_t i = 0; i < temporary_names.size(); ++i) {
        TemporaryName& name = temporary_names[i];
        if (name.claimed.exchange(true)) continue;
        std::memcpy(name.path.data(), path.c_str(), path.size() + 1);
        name.published.store(true);
        return static_cast<int>(i);
    }
    return -1;
}

void withdraw(int slot) noexcept {
    if (slot < 0) return;
    TemporaryName& name = temporary_names[static_cast<std::size_t>(slot)];
    name.published.store(false);
    name.claimed.store(false);
}

std::string reason_of(int error) {
    switch (error) {
        case ENOSPC:
        case EDQUOT: return "the disk is full";
        case EFBIG: return "the file grew beyond the allowed size";
        case EROFS: return "the file system is read-only";
        case EACCES:
        case EPERM: return "permission denied";
        default: return std::strerror(error);
    }
}

[[noreturn]] void throw_fault(const fs::path& target, int error) {
    throw MachineFault(target.string(), "cannot be written: " + reason_of(error),
                       error == ENOSPC || error == EDQUOT ? "free some space; the old file is unchanged" : "");
}

// The number N of `/dev/fd/N` and `/proc/self/fd/N`, else -1. Such a name stands for what is open already: whoever
// opened it goes on writing to that very file, so it must be neither replaced nor written from its start.
int named_descriptor(const fs::path& path) {
    const fs::path folder = path.parent_path();
    if (folder != "/proc/self/fd" && folder != "/dev/fd") return -1;
    const std::string name = path.filename().string();
    int number = -1;
    const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
    return error == std::errc() && end == name.data() + name.size() ? number : -1;
}

// Follows symbolic links by hand up to a file that may not exist yet (std::filesystem::canonical wants it to exist),
// or to the name of an open descriptor.
fs::path followed(fs::path path) {
    for (int depth = 0; depth < 40; ++depth) {
        std::error_code error;
        if (named_descriptor(path) >= 0) return path;
        if (!fs::is_symlink(fs::symlink_status(path, error))) return path;
        const fs::path link = fs::read_symlink(path, error);
        if (error) return path;
        path = link.is_absolute() ? link : path.parent_path() / link;
    }
    throw InvalidInput(path.string(), "symbolic links lead round in a circle");
}

void require_writable_folder(const fs::path& target, const fs::path& folder) {
    std::error_code error;
    if (!fs::exists(folder, error)) {
        throw InvalidInput(target.string(), "the folder '" + folder.string() + "' does not exist", "make it first");
    }
    if (!fs::is_directory(folder, error)) {
        throw InvalidInput(target.string(), "'" + folder.string() + "' is not a folder");
    }
    if (::access(folder.c_str(), W_OK | X_OK) != 0) {
        throw InvalidInput(target.string(),
                           "the folder '" + folder.string() + "' cannot be written: " + reason_of(errno),
                           "choose another folder");
    }
}

}  // namespace

OutputFile::OutputFile(const fs::path& target) : target_(target) {
    if (target.empty()) throw InvalidInput("output", "the file name is empty");
    if (target == "-") {
        descriptor_ = ::dup(STDOUT_FILENO);
        if (descriptor_ < 0) throw InvalidInput("standard output", "is closed");
        return;
    }
    resolved_ = followed(target);
    if (const int number = named_descriptor(resolved_); number >= 0) {
        descriptor_ = ::fcntl(number, F_DUPFD_CLOEXEC, 0);
        if (descriptor_ < 0) throw InvalidInput(target.string(), "is not open");
        return;
    }
    struct stat status {};
    const bool exists = ::stat(resolved_.c_str(), &status) == 0;
    if (exists && S_ISDIR(status.st_mode)) throw InvalidInput(target.string(), "is a folder", "name a file");
    if (exists && !S_ISREG(status.st_mode)) {
        descriptor_ = ::open(resolved_.c_str(), O_WRONLY | O_CLOEXEC);
        if (descriptor_ < 0) throw InvalidInput(target.string(), "cannot be opened for writing: " + reason_of(errno));
        return;
    }
    if (exists && ::access(resolved_.c_str(), W_OK) != 0) {
        throw InvalidInput(target.string(), "the file cannot be written: " + reason_of(errno));
    }
    const fs::path folder = resolved_.has_parent_path() ? resolved_.parent_path() : fs::path(".");
    require_writable_folder(target, folder);

    std::string name = (folder / (".puppetwarp-XXXXXX")).string();
    descriptor_ = ::mkostemp(name.data(), O_CLOEXEC);
    if (descriptor_ < 0) {
        const int error = errno;
        if (error == ENOSPC || error == EDQUOT || error == EMFILE || error == ENFILE) throw_fault(target, error);
        throw InvalidInput(target.string(),
                           "the folder '" + folder.string() + "' cannot be written: " + reason_of(error));
    }
    temporary_ = name;
    slot_ = publish(fs::absolute(temporary_).string());
    // mkstemp makes files private; a new file gets what the umask allows, an existing one keeps its permissions.
    mode_t mode = status.st_mode & 07777;
    if (!exists) {
        const mode_t mask = ::umask(0);
        ::umask(mask);
        mode = 0666 & ~mask;
    }
    ::fchmod(descriptor_, mode);
}

OutputFile::~OutputFile() {
    close_descriptor();
    if (!temporary_.empty()) ::unlink(temporary_.c_str());
    withdraw(slot_);
}

void OutputFile::close_descriptor() noexcept {
    if (descriptor_ >= 0) ::close(descriptor_);
    descriptor_ = -1;
}

void OutputFile::write(std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
        if (written < 0) {
            if (errno == EINTR) continue;
            throw_fault(target_, errno);
        }
        bytes.remove_prefix(static_cast<std::size_t>(written));
    }
}

void OutputFile::commit() {
    if (!seekable()) {
        close_descriptor();
        return;
    }
    if (::fsync(descriptor_) != 0) throw_fault(target_, errno);
    close_descriptor();
    if (::rename(temporary_.c_str(), resolved_.c_str()) != 0) throw_fault(target_, errno);
    withdraw(slot_);
    slot_ = -1;
    temporary_.clear();
}

bool OutputFile::is_stream(const fs::path& target) {
    if (target == "-") return true;
    const fs::path path = followed(target);
    if (named_descriptor(path) >= 0) return true;
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    return fs::exists(status) && !fs::is_regular_file(status) && !fs::is_directory(status);
}

void OutputFile::remove_temporaries() noexcept {
    for (TemporaryName& name : temporary_names) {
        if (name.published.load()) ::unlink(name.path.data());
    }
}

void write_file(const fs::path& target, std::string_view bytes) {
    OutputFile file(target);
    file.write(bytes);
    file.commit();
}

}  // namespace puppetwarp
