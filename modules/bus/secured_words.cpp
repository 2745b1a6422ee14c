#include "modules/bus/secured_words.h"

#include "modules/bus/byte_cursor.h"

namespace palpate::bus {
namespace {

constexpr std::size_t kHeaderBytes = 4;
constexpr std::size_t kPrefixBytes = 20, kCodeBytes = 16;
constexpr std::size_t kReceiversCodeBytes = 20;  // with its key's number

// Their lengths are big-endian, whatever the sub-message's flag says.
Cursor big_endian(std::span<const std::uint8_t> content) { return {content, false}; }

bool is_body(std::span<const std::uint8_t> content) {
  Cursor cursor = big_endian(content);
  const std::size_t encrypted = cursor.four();
  const std::size_t padded = (encrypted + 3) / 4 * 4;
  const std::size_t there = cursor.left().size();
  return !cursor.missing() && encrypted > 0 && (there == encrypted || there == padded);
}

bool is_postfix(std::span<const std::uint8_t> content) {
  Cursor cursor = big_endian(content);
  cursor.skip(kCodeBytes);
  const std::size_t receivers = cursor.four();
  return !cursor.missing() && receivers <= cursor.left().size() &&
         cursor.left().size() == receivers * kReceiversCodeBytes;
}

}  // namespace

bool SecuredWords::follows(std::span<const std::uint8_t> whole) {
  const std::uint8_t kind = whole[0], little_endian = 1;
  if (due_ != 0 && kind != due_) return false;
  if (!is_one(kind)) return true;
  const auto content = whole.subspan(kHeaderBytes);
  // A length of 0 would mean "to the end of the packet": not to every reader.
  const std::size_t length = Cursor(whole.subspan(2, 2), true).two();
  if (whole[1] != little_endian || length != content.size()) return false;
  switch (kind) {
    case kPrefix:
      due_ = kBody;
      return content.size() == kPrefixBytes;
    case kBody: {
      const bool is_due = due_ == kBody;
      due_ = kPostfix;
      return is_due && is_body(content);
    }
    default: {
      const bool is_due = due_ == kPostfix;
      due_ = 0;
      return is_due && is_postfix(content);
    }
  }
}

}  // namespace palpate::bus
