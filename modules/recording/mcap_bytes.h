// Little-endian fields of MCAP records.
#pragma once

#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "modules/core/crc32.h"
#include "modules/recording/mcap_records.h"

namespace palpate::recording {

/// A field reaches beyond the end of its record, or holds what the container forbids.
class McapFieldError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Appends fields to a byte list.
class ByteWriter {
 public:
  explicit ByteWriter(std::vector<std::uint8_t>& bytes) : bytes_(bytes) {}

  ByteWriter& u8(std::uint8_t value) { return number(value, 1); }
  ByteWriter& u16(std::uint16_t value) { return number(value, 2); }
  ByteWriter& u32(std::uint32_t value) { return number(value, 4); }
  ByteWriter& u64(std::uint64_t value) { return number(value, 8); }
  ByteWriter& raw(std::span<const std::uint8_t> data);
  ByteWriter& text(std::string_view value);  ///< length u32, bytes
  ByteWriter& text_map(const McapMap& map);  ///< length in bytes u32, entries

 private:
  ByteWriter& number(std::uint64_t value, std::size_t size);  ///< its low bytes, lowest first

  std::vector<std::uint8_t>& bytes_;
};

/// Takes fields from the front of one record's content. @throws McapFieldError where too few
/// bytes are left
class ByteReader {
 public:
  explicit ByteReader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

  std::uint8_t u8() { return static_cast<std::uint8_t>(number(1)); }
  std::uint16_t u16() { return static_cast<std::uint16_t>(number(2)); }
  std::uint32_t u32() { return static_cast<std::uint32_t>(number(4)); }
  std::uint64_t u64() { return number(8); }
  std::string text();
  McapMap text_map();
  std::span<const std::uint8_t> take(std::size_t size);
  std::span<const std::uint8_t> rest() const { return bytes_; }

 private:
  std::uint64_t number(std::size_t size);

  std::span<const std::uint8_t> bytes_;
};

}  // namespace palpate::recording
