#include "modules/bus/authentication_words.h"

#include "modules/bus/byte_cursor.h"

namespace palpate::bus {
namespace {

constexpr std::size_t kEncapsulationBytes = 4;
constexpr std::size_t kIdentityBytes = 24, kKeyBytes = 16;

/// A length, so many bytes, and what fills the last four of them.
std::span<const std::uint8_t> octets(Cursor& cursor) {
  const std::size_t length = cursor.four();
  const auto there = cursor.left().first(std::min(length, cursor.left().size()));
  cursor.skip(length);
  cursor.skip((4 - length % 4) % 4);
  return there;
}

bool is_text(Cursor& cursor) {
  const auto text = octets(cursor);
  return !cursor.missing() && !text.empty() && text.back() == 0;
}

template <class IsElement>
bool is_list(Cursor& cursor, const IsElement& is_element) {
  for (std::uint32_t count = cursor.four(); count > 0; --count) {
    if (!is_element(cursor)) return false;
  }
  return !cursor.missing();
}

bool is_property(Cursor& cursor) { return is_text(cursor) && is_text(cursor); }

bool is_binary_property(Cursor& cursor) {
  if (!is_text(cursor)) return false;
  octets(cursor);
  return !cursor.missing();
}

bool is_data_holder(Cursor& cursor) {
  return is_text(cursor) && is_list(cursor, is_property) && is_list(cursor, is_binary_property);
}

}  // namespace

bool is_generic_message(std::span<const std::uint8_t> payload) {
  if (payload.size() < kEncapsulationBytes) return false;
  Cursor cursor(payload.subspan(kEncapsulationBytes), (payload[1] & 1) != 0);
  cursor.skip(2 * kIdentityBytes + 3 * kKeyBytes);
  return is_text(cursor) && is_list(cursor, is_data_holder);
}

}  // namespace palpate::bus
