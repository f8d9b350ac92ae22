#include <puppetwarp/image/png_check.h>

#include <puppetwarp/image/vips_decode.h>

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <string_view>
#include <vector>

#include <unistd.h>

namespace puppetwarp {

namespace {

using namespace std::literals;

constexpr std::uint64_t signature_bytes = 8;
constexpr std::uint64_t chunk_frame_bytes = 12;  // length, name, checksum

void read_at(const PictureFile& file, std::uint64_t offset, std::uint8_t* bytes, std::size_t count) {
    while (count > 0) {
        const ssize_t got = ::pread(file.descriptor(), bytes, count, static_cast<off_t>(offset));
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) throw_damaged(file.name(), "");
        bytes += got;
        offset += static_cast<std::uint64_t>(got);
        count -= static_cast<std::size_t>(got);
    }
}

std::uint32_t be32(const std::uint8_t* bytes) {
    return std::uint32_t{bytes[0]} << 24 | std::uint32_t{bytes[1]} << 16 | std::uint32_t{bytes[2]} << 8 | bytes[3];
}

struct Chunk {
    std::uint64_t offset = 0;  // of its length; 0: no chunk
    std::uint64_t length = 0;  // of its body
};

struct Walk {
    Chunk last_pixels;
    PngFrame frame;
};

Walk walk_chunks(const PictureFile& file) {
    Walk walk;
    for (std::uint64_t at = signature_bytes;;) {
        std::array<std::uint8_t, 8> head{};
        read_at(file, at, head.data(), head.size());
        const std::uint64_t length = be32(head.data());
        if (length + chunk_frame_bytes > file.size_bytes() - at) throw_damaged(file.name(), "");
        const std::string_view name(reinterpret_cast<const char*>(head.data()) + 4, 4);
        if (name == "IDAT") walk.last_pixels = {at, length};
        if (name == "pHYs") walk.frame.has_resolution = true;
        if (name == "IEND") return walk;
        at += length + chunk_frame_bytes;
    }
}

}  // namespace

bool is_png(const PictureFile& file) {
    return file.signature().starts_with("\x89PNG\r\n\x1a\n"sv);
}

PngFrame require_whole_png(const PictureFile& file) {
    const Walk walk = walk_chunks(file);
    const Chunk& last = walk.last_pixels;
    if (last.offset == 0) throw_damaged(file.name(), "it holds no pixels");
    std::vector<std::uint8_t> piece(std::size_t{1} << 16);
    std::uint64_t at = last.offset + 4;  // the name counts, the length does not
    const std::uint64_t end = at + 4 + last.length;
    uLong crc = crc32(0, nullptr, 0);
    while (at < end) {
        const std::size_t count = static_cast<std::size_t>(std::min<std::uint64_t>(piece.size(), end - at));
        read_at(file, at, piece.data(), count);
        crc = crc32(crc, piece.data(), static_cast<uInt>(count));
        at += count;
    }
    read_at(file, end, piece.data(), 4);
    if (be32(piece.data()) != crc) throw_damaged(file.name(), "a checksum is wrong");
    return walk.frame;
}

}  // namespace puppetwarp
