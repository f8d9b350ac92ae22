#include <puppetwarp/image/exr_stream.h>

#include <ImfOutputFile.h>  // declared by ImfIO.h; our own class has its name

#include <cerrno>

#include <unistd.h>

namespace puppetwarp {

bool ExrInput::read(char bytes[], int count) {
    for (int done = 0; done < count;) {
        const ssize_t got = ::pread(file_.descriptor(), bytes + done, static_cast<std::size_t>(count - done),
                                    static_cast<off_t>(position_));
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) throw InvalidInput(file_.name(), "the file is truncated or damaged");
        done += static_cast<int>(got);
        position_ += static_cast<std::uint64_t>(got);
    }
    return position_ < file_.size_bytes();
}

void ExrOutput::write(const char bytes[], int count) {
    try {
        file_.write({bytes, static_cast<std::size_t>(count)});
    } catch (...) {
        if (!failure_) failure_ = std::current_exception();
        throw;
    }
}

std::uint64_t ExrOutput::tellp() {
    return static_cast<std::uint64_t>(::lseek(file_.descriptor(), 0, SEEK_CUR));
}

void ExrOutput::seekp(std::uint64_t position) {
    ::lseek(file_.descriptor(), static_cast<off_t>(position), SEEK_SET);
}

}  // namespace puppetwarp
