#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace puppetwarp {

//! A file that appears whole or not at all: written beside its target, synced, then renamed over it by `commit()`.
//! A symbolic link is followed, permissions of an existing file are kept. A target that exists and is not a regular
//! file (a pipe, a terminal) is written directly, and so is an open descriptor named by path (`/dev/stdout`,
//! `/dev/fd/3`), even where it leads to a file. Without `commit()` the target stays as it was.
class OutputFile {
public:
    //! \param target  where the file shall be; `-` is standard output.
    //! \throw InvalidInput  the folder is missing or cannot be written, the target is a folder or read-only.
    explicit OutputFile(const std::filesystem::path& target);
    ~OutputFile();
    OutputFile(const OutputFile&) = delete;
    OutputFile& operator=(const OutputFile&) = delete;

    //! An open descriptor to write to. A regular target's is seekable; do not close it.
    int descriptor() const { return descriptor_; }
    //! False for pipes, terminals and devices.
    bool seekable() const { return !temporary_.empty(); }
    const std::filesystem::path& target() const { return target_; }

    //! Appends bytes. \throw MachineFault  disk full or another fault of the machine; the old file is whole.
    void write(std::string_view bytes);
    //! Syncs and renames. At most once; nothing may be written afterwards. \throw MachineFault  as `write`.
    void commit();

    //! Whether this target is written directly, piece by piece: `-`, `/dev/stdout`, pipes, devices.
    static bool is_stream(const std::filesystem::path& target);

    //! Removes the temporary files of all unfinished OutputFiles of this process. Async-signal-safe.
    static void remove_temporaries() noexcept;

private:
    void close_descriptor() noexcept;

    std::filesystem::path target_;     // as given, for messages
    std::filesystem::path resolved_;   // with symbolic links followed
    std::filesystem::path temporary_;  // empty: written directly
    int descriptor_ = -1;
    int slot_ = -1;  // of the list that remove_temporaries() walks
};

//! Writes a whole file at once, as OutputFile does. \throw InvalidInput, MachineFault.
void write_file(const std::filesystem::path& target, std::string_view bytes);

}  // namespace puppetwarp
