#include "modules/messages/message_types.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "modules/messages/cdr.h"
#include "modules/messages/describe.h"
#include "modules/messages/key_of.h"
#include "modules/messages/message_checks.h"

namespace palpate::messages {
namespace {

constexpr std::size_t kHeaderBytes = 32, kSourceTimeAt = 16, kTokenAt = 24;

template <class Message>
MessageType::Key key_kind() {
  KeyOf key;
  const Message message;
  describe(key, message);
  return key.kind;
}

template <class Message>
const char* decode_any(Payload payload, AnyMessage& message) {
  if (!std::holds_alternative<Message>(message)) message.emplace<Message>();
  return decode(payload, std::get<Message>(message));
}

bool is_big_endian(Payload payload) { return (payload[1] & 1u) == 0; }

template <class T>
T number(Payload payload, std::size_t place) {
  std::array<std::uint8_t, sizeof(T)> bytes;
  std::memcpy(bytes.data(), payload.data() + kEncapsulationBytes + place, sizeof(T));
  if (is_big_endian(payload)) std::ranges::reverse(bytes);
  return std::bit_cast<T>(bytes);
}

template <class T>
void put(T value, std::span<std::uint8_t> payload, std::size_t place) {
  auto bytes = std::bit_cast<std::array<std::uint8_t, sizeof value>>(value);
  if (is_big_endian(payload)) std::ranges::reverse(bytes);
  std::ranges::copy(bytes,
                    payload.begin() + static_cast<std::ptrdiff_t>(kEncapsulationBytes + place));
}

void append_big_endian(KeyBytes& key, std::uint32_t value) {
  for (const int shift : {24, 16, 8, 0})
    key.bytes[key.size++] = static_cast<std::uint8_t>(value >> shift);
}

/// Strictly within what a codec takes: the sum of two such fits.
bool can_be_added(std::int64_t time_ns) { return -kMaxTimeNs < time_ns && time_ns < kMaxTimeNs; }

KeyBytes unreadable() {
  KeyBytes key;
  key.readable = false;
  return key;
}

}  // namespace

#define PALPATE_INSTANTIATE(Message)                                                        \
  template <>                                                                               \
  const MessageType& type_of<Message>() {                                                   \
    static const MessageType type{#Message, "palpate::idl::" #Message, key_kind<Message>(), \
                                  decode_any<Message>};                                     \
    return type;                                                                            \
  }
PALPATE_MESSAGES(PALPATE_INSTANTIATE)
#undef PALPATE_INSTANTIATE

std::vector<AnyMessage> one_of_each() {
  std::vector<AnyMessage> messages;
#define PALPATE_ENTRY(Message) messages.emplace_back(std::in_place_type<Message>);
  PALPATE_MESSAGES(PALPATE_ENTRY)
#undef PALPATE_ENTRY
  return messages;
}

KeyBytes key_of(const MessageType& type, Payload payload) {
  KeyBytes key;
  if (type.key == MessageType::Key::kNone) return key;
  constexpr std::size_t kFirst = kEncapsulationBytes + kHeaderBytes + sizeof(std::uint32_t);
  if (payload.size() < kFirst) return unreadable();
  const auto value = number<std::uint32_t>(payload, kHeaderBytes);
  append_big_endian(key, value);
  if (type.key == MessageType::Key::kNumber) return key;
  if (type.key == MessageType::Key::kTwoNumbers) {
    constexpr std::size_t kSecond = kHeaderBytes + sizeof(std::uint32_t);
    if (payload.size() < kEncapsulationBytes + kSecond + sizeof(std::uint32_t)) return unreadable();
    append_big_endian(key, number<std::uint32_t>(payload, kSecond));
    return key;
  }
  // A text: its length, with the zero byte that ends it, and its bytes.
  if (value > kMaxNameBytes + 1 || payload.size() - kFirst < value) return unreadable();
  std::memcpy(key.bytes.data() + key.size, payload.data() + kFirst, value);
  key.size += value;
  return key;
}

Header header_of(Payload payload) {
  if (payload.size() < kEncapsulationBytes + kHeaderBytes) return {};
  return {number<std::uint64_t>(payload, 0), number<std::int64_t>(payload, 8),
          number<std::int64_t>(payload, kSourceTimeAt), number<std::uint64_t>(payload, kTokenAt)};
}

std::optional<std::uint64_t> token_of(Payload payload) {
  if (payload.size() < kEncapsulationBytes + kHeaderBytes) return std::nullopt;
  return number<std::uint64_t>(payload, kTokenAt);
}

void set_token(std::span<std::uint8_t> payload, std::uint64_t token) {
  if (payload.size() < kEncapsulationBytes + kHeaderBytes) return;
  put(token, payload, kTokenAt);
}

void set_sequence(std::span<std::uint8_t> payload, std::uint64_t sequence) {
  if (payload.size() < kEncapsulationBytes + kHeaderBytes) return;
  put(sequence, payload, 0);
}

void shift_times(const MessageType& type, std::int64_t shift_ns,
                 std::vector<std::uint8_t>& payload) {
  if (payload.size() < kEncapsulationBytes + kHeaderBytes) return;
  const std::int64_t source_ns = number<std::int64_t>(payload, kSourceTimeAt);
  if (!can_be_added(source_ns) || !can_be_added(shift_ns)) return;
  put<std::int64_t>(std::max<std::int64_t>(1, source_ns + shift_ns), payload, kSourceTimeAt);
  if (&type != &type_of<SessionControl>()) return;
  SessionControl control;
  if (read_payload(payload, control) != nullptr || !can_be_added(control.start_time_ns)) return;
  control.start_time_ns += shift_ns;
  write_payload(control, payload);
}

}  // namespace palpate::messages
