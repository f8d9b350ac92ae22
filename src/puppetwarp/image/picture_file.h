#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace puppetwarp {

//! A picture file open for reading: regular, readable, not empty.
class PictureFile {
public:
    //! \throw InvalidInput  as `require_readable_file`.
    explicit PictureFile(const std::filesystem::path& path);
    ~PictureFile();
    PictureFile(const PictureFile&) = delete;
    PictureFile& operator=(const PictureFile&) = delete;

    int descriptor() const { return descriptor_; }
    std::uint64_t size_bytes() const { return size_bytes_; }
    //! The first bytes of the file, at most 16.
    const std::string& signature() const { return signature_; }
    //! The path as given, for messages.
    std::string name() const { return path_.string(); }

private:
    std::filesystem::path path_;
    int descriptor_ = -1;
    std::uint64_t size_bytes_ = 0;
    std::string signature_;
};

}  // namespace puppetwarp
