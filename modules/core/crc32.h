// What tells that bytes are not those that were written.
#pragma once

#include <cstdint>
#include <span>

namespace palpate {

/// CRC-32 (polynomial 0xEDB88320, as zlib's).
/// @param before  of the bytes that come before these: crc32(ab) = crc32(b, crc32(a))
std::uint32_t crc32(std::span<const std::uint8_t> bytes, std::uint32_t before = 0);

}  // namespace palpate
