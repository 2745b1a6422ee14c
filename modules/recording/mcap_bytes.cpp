#include "modules/recording/mcap_bytes.h"

#include <algorithm>

namespace palpate::recording {
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

}  // namespace palpate::recording
