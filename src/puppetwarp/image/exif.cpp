#include <puppetwarp/image/exif.h>

#include <cstddef>
#include <cstring>
#include <optional>

// EXIF 2.32: a TIFF header, then directories of 12-byte entries; orientation is a SHORT of the first directory.

namespace puppetwarp {

namespace {

constexpr std::uint16_t orientation_tag = 0x0112;
constexpr std::uint16_t x_resolution_tag = 0x011a;
constexpr std::uint16_t short_type = 3;
constexpr std::uint16_t rational_type = 5;

class TiffBytes {
public:
    explicit TiffBytes(std::span<const std::uint8_t> bytes) : bytes_(bytes) {
        if (bytes.size() < 8) return;
        little_ = bytes[0] == 'I' && bytes[1] == 'I';
        valid_ = (little_ || (bytes[0] == 'M' && bytes[1] == 'M')) && short_at(2) == 42;
    }

    bool valid() const { return valid_; }
    bool little() const { return little_; }
    bool holds(std::size_t offset, std::size_t count) const {
        return offset <= bytes_.size() && count <= bytes_.size() - offset;
    }
    std::uint16_t short_at(std::size_t offset) const {
        const int low = little_ ? 0 : 1;
        return static_cast<std::uint16_t>(bytes_[offset + low] | bytes_[offset + 1 - low] << 8);
    }
    std::uint32_t long_at(std::size_t offset) const {
        const std::uint32_t first = short_at(offset);
        const std::uint32_t second = short_at(offset + 2);
        return little_ ? first | second << 16 : first << 16 | second;
    }

private:
    std::span<const std::uint8_t> bytes_;
    bool little_ = false;
    bool valid_ = false;
};

// Where an entry of the first directory stands.
std::optional<std::size_t> entry_offset(const TiffBytes& tiff, std::uint16_t tag, std::uint16_t type) {
    if (!tiff.valid()) return std::nullopt;
    const std::size_t directory = tiff.long_at(4);
    if (!tiff.holds(directory, 2)) return std::nullopt;
    const std::size_t entries = tiff.short_at(directory);
    for (std::size_t i = 0; i < entries; ++i) {
        const std::size_t entry = directory + 2 + 12 * i;
        if (!tiff.holds(entry, 12)) return std::nullopt;
        if (tiff.short_at(entry) == tag && tiff.short_at(entry + 2) == type) return entry;
    }
    return std::nullopt;
}

// Where the value of the orientation stands.
std::optional<std::size_t> orientation_offset(const TiffBytes& tiff) {
    const std::optional<std::size_t> entry = entry_offset(tiff, orientation_tag, short_type);
    return entry ? std::optional(*entry + 8) : std::nullopt;
}

}  // namespace

std::span<const std::uint8_t> without_exif_prefix(std::span<const std::uint8_t> block) {
    constexpr std::size_t prefix = 6;
    const bool prefixed = block.size() >= prefix && std::memcmp(block.data(), "Exif\0\0", prefix) == 0;
    return prefixed ? block.subspan(prefix) : block;
}

int exif_orientation(std::span<const std::uint8_t> exif) {
    const TiffBytes tiff(exif);
    const std::optional<std::size_t> offset = orientation_offset(tiff);
    if (!offset) return 1;
    const int orientation = tiff.short_at(*offset);
    return orientation >= 1 && orientation <= 8 ? orientation : 1;
}

bool has_exif_resolution(std::span<const std::uint8_t> exif) {
    return entry_offset(TiffBytes(exif), x_resolution_tag, rational_type).has_value();
}

void reset_exif_orientation(std::vector<std::uint8_t>& exif) {
    const TiffBytes tiff(exif);
    const std::optional<std::size_t> offset = orientation_offset(tiff);
    if (!offset) return;
    exif[*offset] = tiff.little() ? 1 : 0;
    exif[*offset + 1] = tiff.little() ? 0 : 1;
}

}  // namespace puppetwarp
