#include <puppetwarp/image/png_pixels.h>

#include <puppetwarp/image/png_check.h>

#include <libdeflate.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include <sys/mman.h>
#include <unistd.h>

namespace puppetwarp {

namespace {

using namespace std::literals;

constexpr std::size_t kMostBytes = std::size_t{192} << 20;
constexpr std::size_t kSignatureBytes = 8, kHeaderBytes = 13;
constexpr std::size_t kChunkFrameBytes = 12;  // length, name, checksum

// Asks for few large pages where memory has not been touched yet: giving out thousands of small ones takes as long as
// filling them. That it is not granted does no harm.
void want_large_pages(std::uint8_t* bytes, std::size_t count) {
    constexpr std::uintptr_t page = 4096;
    const auto begin = (reinterpret_cast<std::uintptr_t>(bytes) + page - 1) / page * page;
    const auto end = (reinterpret_cast<std::uintptr_t>(bytes) + count) / page * page;
    if (begin < end) ::madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE);
}

// Bytes that nobody has set to 0 first.
struct Buffer {
    std::unique_ptr<std::uint8_t[]> bytes;
    std::size_t size = 0;

    explicit Buffer(std::size_t count) : bytes(new std::uint8_t[count]), size(count) {
        want_large_pages(bytes.get(), count);
    }
};

struct FreeDecompressor {
    void operator()(libdeflate_decompressor* decompressor) const { libdeflate_free_decompressor(decompressor); }
};

std::uint32_t be32(const std::uint8_t* bytes) {
    return std::uint32_t{bytes[0]} << 24 | std::uint32_t{bytes[1]} << 16 | std::uint32_t{bytes[2]} << 8 | bytes[3];
}

bool read_whole(const PictureFile& file, Buffer& buffer) {
    for (std::size_t at = 0; at < buffer.size;) {
        const ssize_t got =
            ::pread(file.descriptor(), buffer.bytes.get() + at, buffer.size - at, static_cast<off_t>(at));
        if (got < 0 && errno == EINTR) continue;
        if (got <= 0) return false;
        at += static_cast<std::size_t>(got);
    }
    return true;
}

struct Chunk {
    std::string_view name;
    std::uint8_t* body = nullptr;
    std::size_t length = 0;
};

// The chunk at `at`, or nothing where the file ends within it or its checksum is wrong.
std::optional<Chunk> chunk_at(const Buffer& file, std::size_t at) {
    if (file.size - at < kChunkFrameBytes) return std::nullopt;
    std::uint8_t* frame = file.bytes.get() + at;
    const std::size_t length = be32(frame);
    if (length > file.size - at - kChunkFrameBytes) return std::nullopt;
    const Chunk chunk{{reinterpret_cast<const char*>(frame) + 4, 4}, frame + 8, length};
    if (libdeflate_crc32(0, frame + 4, length + 4) != be32(chunk.body + length)) return std::nullopt;
    return chunk;
}

bool is_plain_header(const Chunk& header, int width, int height, int type) {
    constexpr int kColourTypes[]{0, 4, 2, 6};  // grey, grey + alpha, RGB, RGB + alpha
    const int bits = CV_MAT_DEPTH(type) == CV_8U ? 8 : 16;
    return header.name == "IHDR"sv && header.length == kHeaderBytes &&
           be32(header.body) == static_cast<std::uint32_t>(width) &&
           be32(header.body + 4) == static_cast<std::uint32_t>(height) && header.body[8] == bits &&
           header.body[9] == kColourTypes[CV_MAT_CN(type) - 1] && header.body[10] == 0 && header.body[11] == 0 &&
           header.body[12] == 0;
}

// Moves the bodies of the pixel chunks together, to the front of the file's bytes; how many there are, or nothing.
std::optional<std::size_t> gather_pixels(Buffer& file, int width, int height, int type) {
    std::optional<Chunk> chunk = chunk_at(file, kSignatureBytes);
    if (!chunk || !is_plain_header(*chunk, width, height, type)) return std::nullopt;
    std::size_t packed = 0;
    bool pixels_ended = false;
    for (std::size_t at = kSignatureBytes; chunk->name != "IEND"sv;) {
        at += kChunkFrameBytes + chunk->length;
        chunk = chunk_at(file, at);
        if (!chunk || chunk->name == "tRNS"sv || chunk->name == "PLTE"sv) return std::nullopt;
        if (chunk->name != "IDAT"sv) {
            pixels_ended = packed > 0;
            continue;
        }
        if (pixels_ended) return std::nullopt;
        std::memmove(file.bytes.get() + packed, chunk->body, chunk->length);
        packed += chunk->length;
    }
    return packed;
}

std::uint8_t paeth(int left, int above, int corner) {
    const int to_left = std::abs(above - corner), to_above = std::abs(left - corner);
    const int to_corner = std::abs(left + above - 2 * corner);
    const int nearer = to_above <= to_corner ? above : corner;
    return static_cast<std::uint8_t>(to_left <= to_above && to_left <= to_corner ? left : nearer);
}

// Undoes a row's filter in place. `kBytes` of a pixel; `above` is the row before, all 0 for the first.
template <int kBytes>
bool unfilter(std::uint8_t filter, std::uint8_t* row, const std::uint8_t* above, std::size_t bytes) {
    const auto add = [](int a, int b) { return static_cast<std::uint8_t>(a + b); };
    std::uint8_t left[kBytes] = {}, corner[kBytes] = {};
    switch (filter) {
        case 0: return true;
        case 1:
            for (std::size_t i = 0; i < bytes; i += kBytes) {
                for (int c = 0; c < kBytes; ++c) row[i + c] = left[c] = add(row[i + c], left[c]);
            }
            return true;
        case 2:
            for (std::size_t i = 0; i < bytes; ++i) row[i] = add(row[i], above[i]);
            return true;
        case 3:
            for (std::size_t i = 0; i < bytes; i += kBytes) {
                for (int c = 0; c < kBytes; ++c) row[i + c] = left[c] = add(row[i + c], (left[c] + above[i + c]) / 2);
            }
            return true;
        case 4:
            for (std::size_t i = 0; i < bytes; i += kBytes) {
                for (int c = 0; c < kBytes; ++c) {
                    row[i + c] = left[c] = add(row[i + c], paeth(left[c], above[i + c], corner[c]));
                    corner[c] = above[i + c];
                }
            }
            return true;
        default: return false;
    }
}

// Undoes the filters of all rows and moves the rows together, to the front of `bytes`.
template <int kBytes>
bool unfilter_rows(std::uint8_t* bytes, int width, int height) {
    const std::size_t row_bytes = static_cast<std::size_t>(width) * kBytes;
    const std::vector<std::uint8_t> zeros(row_bytes);
    const std::uint8_t* above = zeros.data();
    for (int y = 0; y < height; ++y) {
        std::uint8_t* row = bytes + static_cast<std::size_t>(y) * (row_bytes + 1) + 1;
        std::uint8_t* place = bytes + static_cast<std::size_t>(y) * row_bytes;
        if (!unfilter<kBytes>(row[-1], row, above, row_bytes)) return false;
        std::memmove(place, row, row_bytes);
        above = place;
    }
    return true;
}

bool unfilter_rows(std::uint8_t* bytes, int width, int height, std::size_t pixel_bytes) {
    switch (pixel_bytes) {
        case 1: return unfilter_rows<1>(bytes, width, height);
        case 2: return unfilter_rows<2>(bytes, width, height);
        case 3: return unfilter_rows<3>(bytes, width, height);
        case 4: return unfilter_rows<4>(bytes, width, height);
        case 6: return unfilter_rows<6>(bytes, width, height);
        default: return unfilter_rows<8>(bytes, width, height);
    }
}

// PNG has the more significant byte first.
void to_own_byte_order(cv::Mat& values) {
    auto* value = values.ptr<std::uint16_t>();
    for (std::size_t i = 0; i < values.total(); ++i) {
        const auto* bytes = reinterpret_cast<const std::uint8_t*>(value + i);
        value[i] = static_cast<std::uint16_t>(bytes[0] << 8 | bytes[1]);
    }
}

bool inflate(const Buffer& packed, std::size_t packed_bytes, std::uint8_t* bytes, std::size_t count) {
    const std::unique_ptr<libdeflate_decompressor, FreeDecompressor> decompressor(libdeflate_alloc_decompressor());
    return decompressor && libdeflate_zlib_decompress(decompressor.get(), packed.bytes.get(), packed_bytes, bytes,
                                                      count, nullptr) == LIBDEFLATE_SUCCESS;
}

}  // namespace

cv::Mat plain_png_pixels(const PictureFile& file, int width, int height, int type) {
    const std::size_t pixel_bytes = CV_ELEM_SIZE(type);
    const std::size_t row_bytes = static_cast<std::size_t>(width) * pixel_bytes + 1;  // with its filter
    if (!is_png(file) || row_bytes > kMostBytes / static_cast<std::size_t>(height)) return {};
    if (file.size_bytes() > kMostBytes) return {};
    Buffer packed(file.size_bytes());
    if (!read_whole(file, packed)) return {};
    const std::optional<std::size_t> packed_bytes = gather_pixels(packed, width, height, type);
    if (!packed_bytes) return {};

    // Rows are unpacked, unfiltered and moved together in the memory that they stay in, one value after the other.
    const int depth = CV_MAT_DEPTH(type), channels = CV_MAT_CN(type);
    const std::size_t bytes = row_bytes * static_cast<std::size_t>(height);
    cv::Mat values(1, static_cast<int>(bytes / CV_ELEM_SIZE1(type)) + 1, depth);
    want_large_pages(values.data, bytes);
    if (!inflate(packed, *packed_bytes, values.data, bytes)) return {};
    if (!unfilter_rows(values.data, width, height, pixel_bytes)) return {};
    values = values.colRange(0, width * height * channels);
    if (depth == CV_16U) to_own_byte_order(values);
    return values.reshape(channels, height);
}

}  // namespace puppetwarp
