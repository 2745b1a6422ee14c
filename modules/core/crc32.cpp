#include "modules/core/crc32.h"

#include <array>
#include <cstddef>

namespace palpate {
namespace {

// Eight bytes at a time: table k holds the CRC of one byte that k others follow. Every byte of a
// recording goes through here, as it is written and as it is read.
constexpr std::size_t kCrcSlices = 8;
using CrcTables = std::array<std::array<std::uint32_t, 256>, kCrcSlices>;

constexpr CrcTables make_crc_tables() {
  CrcTables tables{};
  for (std::uint32_t byte = 0; byte < 256; ++byte) {
    std::uint32_t crc = byte;
    for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ ((crc & 1u) != 0 ? 0xEDB88320u : 0u);
    tables[0][byte] = crc;
  }
  for (std::size_t k = 1; k < kCrcSlices; ++k) {
    for (std::size_t byte = 0; byte < 256; ++byte) {
      const std::uint32_t before = tables[k - 1][byte];
      tables[k][byte] = before >> 8 ^ tables[0][before & 0xFFu];
    }
  }
  return tables;
}

constexpr CrcTables kCrcTables = make_crc_tables();

}  // namespace

std::uint32_t crc32(std::span<const std::uint8_t> bytes, std::uint32_t before) {
  std::uint32_t crc = ~before;
  for (; bytes.size() >= kCrcSlices; bytes = bytes.subspan(kCrcSlices)) {
    std::uint32_t next = 0;
    for (std::size_t i = 0; i < kCrcSlices; ++i) {
      const std::uint32_t byte = bytes[i] ^ (i < 4 ? crc >> (8 * i) & 0xFFu : 0u);
      next ^= kCrcTables[kCrcSlices - 1 - i][byte];
    }
    crc = next;
  }
  for (const std::uint8_t byte : bytes) crc = crc >> 8 ^ kCrcTables[0][(crc ^ byte) & 0xFFu];
  return ~crc;
}

}  // namespace palpate
