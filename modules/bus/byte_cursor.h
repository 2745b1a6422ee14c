// Numbers out of bytes that nobody has checked.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>

namespace palpate::bus {

/// Reads in the order of bytes that a sub-message says; what is not there reads as 0 and is
/// remembered.
class Cursor {
 public:
  Cursor(std::span<const std::uint8_t> bytes, bool little) : bytes_(bytes), little_(little) {}

  void skip(std::size_t count) {
    if (count > bytes_.size()) missing_ = true;
    bytes_ = bytes_.subspan(std::min(count, bytes_.size()));
  }
  std::uint32_t number(std::size_t size) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < size && i < bytes_.size(); ++i) {
      value |= std::uint32_t{bytes_[i]} << 8 * (little_ ? i : size - 1 - i);
    }
    skip(size);
    return value;
  }
  std::uint16_t two() { return static_cast<std::uint16_t>(number(2)); }
  std::uint32_t four() { return number(4); }
  std::uint32_t entity() {  // big-endian, whatever the sub-message says
    const Cursor big(bytes_.first(std::min<std::size_t>(4, bytes_.size())), false);
    skip(4);
    return Cursor(big).four();
  }
  std::int64_t sequence() {
    const std::uint64_t high = four();
    const std::uint64_t low = four();
    return static_cast<std::int64_t>(high << 32 | low);
  }
  std::span<const std::uint8_t> left() const { return bytes_; }
  bool missing() const { return missing_; }

 private:
  std::span<const std::uint8_t> bytes_;
  bool little_;
  bool missing_ = false;
};

}  // namespace palpate::bus
