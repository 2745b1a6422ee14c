#include "modules/recording/mcap_bytes.h"

#include <algorithm>
#include <array>

namespace palpate::recording {
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

ByteWriter& ByteWriter::number(std::uint64_t value, std::size_t size) {
  for (std::size_t i = 0; i < size; ++i) {
    bytes_.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
  }
  return *this;
}

ByteWriter& ByteWriter::raw(std::span<const std::uint8_t> data) {
  const std::size_t before = bytes_.size();
  bytes_.resize(before + data.size());
  std::copy(data.begin(), data.end(), bytes_.data() + before);
  return *this;
}

ByteWriter& ByteWriter::text(std::string_view value) {
  u32(static_cast<std::uint32_t>(value.size()));
  return raw({reinterpret_cast<const std::uint8_t*>(value.data()), value.size()});
}

ByteWriter& ByteWriter::text_map(const McapMap& map) {
  std::size_t size = 0;
  for (const auto& [key, value] : map) size += 8 + key.size() + value.size();
  u32(static_cast<std::uint32_t>(size));
  for (const auto& [key, value] : map) text(key).text(value);
  return *this;
}

std::uint64_t ByteReader::number(std::size_t size) {
  const auto field = take(size);
  std::uint64_t value = 0;
  for (std::size_t i = size; i-- > 0;) value = value << 8 | field[i];
  return value;
}

std::string ByteReader::text() {
  const auto field = take(u32());
  return {field.begin(), field.end()};
}

McapMap ByteReader::text_map() {
  ByteReader entries(take(u32()));
  McapMap map;
  while (!entries.rest().empty()) {
    std::string key = entries.text();
    map[std::move(key)] = entries.text();
  }
  return map;
}

std::span<const std::uint8_t> ByteReader::take(std::size_t size) {
  if (size > bytes_.size()) {
    throw McapFieldError("a field of " + std::to_string(size) + " bytes where " +
                         std::to_string(bytes_.size()) + " are left of the record");
  }
  const auto field = bytes_.first(size);
  bytes_ = bytes_.subspan(size);
  return field;
}

std::string printable(std::string text) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const auto before = static_cast<unsigned char>(i == 0 ? 0 : text[i - 1]);
    const bool high = before == 0xC2 && byte >= 0x80 && byte < 0xA0;  // U+0080 … U+009F in UTF-8
    if (byte < 0x20 || byte == 0x7F || high) text[i] = '?';
    if (high) text[i - 1] = '?';
  }
  return text;
}

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

}  // namespace palpate::recording
