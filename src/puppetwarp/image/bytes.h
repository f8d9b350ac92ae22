#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace puppetwarp {

inline void append_be16(std::string& bytes, std::uint16_t value) {
    bytes += static_cast<char>(value >> 8);
    bytes += static_cast<char>(value & 0xff);
}

inline void append_be32(std::string& bytes, std::uint32_t value) {
    append_be16(bytes, static_cast<std::uint16_t>(value >> 16));
    append_be16(bytes, static_cast<std::uint16_t>(value & 0xffff));
}

//! `width_bytes` low bytes of a value, the lowest first.
inline void append_le(std::string& bytes, std::uint32_t value, int width_bytes) {
    for (int i = 0; i < width_bytes; ++i) bytes += static_cast<char>((value >> (8 * i)) & 0xff);
}

inline std::string_view as_text(const std::vector<std::uint8_t>& bytes) {
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace puppetwarp
