// The kinds of message there are, and what can be done with one whose kind is known only at run
// time.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <variant>
#include <vector>

#include "modules/messages/messages.h"

namespace palpate::messages {

template <class, class... Messages>
struct OneOf {
  using type = std::variant<Messages...>;
};
#define PALPATE_NEXT(Message) , Message
/// Any of PALPATE_MESSAGES.
using AnyMessage = OneOf<void PALPATE_MESSAGES(PALPATE_NEXT)>::type;
#undef PALPATE_NEXT

/// A message as it travels: CDR after its 4 bytes of encapsulation header.
using Payload = std::span<const std::uint8_t>;

struct MessageType {
  enum class Key { kNone, kNumber, kTwoNumbers, kText };

  std::string_view name;       ///< "ProbeState"
  std::string_view wire_name;  ///< "palpate::idl::ProbeState"
  Key key;                     ///< right after the header
  /// Fills `message` with a message of this kind (cdr.h).
  const char* (*decode)(Payload payload, AnyMessage& message);
};

template <class Message>
const MessageType& type_of();

/// A fresh message of each kind.
std::vector<AnyMessage> one_of_each();

/// A message's key as DDS sees it: the key fields in big-endian CDR, at most a name of 64 bytes.
/// Messages without key all have the same, an empty one. No allocation.
struct KeyBytes {
  std::array<std::uint8_t, 72> bytes{};
  std::size_t size = 0;
  bool readable = true;  ///< false: the payload holds no key where it must be

  bool operator==(const KeyBytes& other) const {
    return size == other.size && readable == other.readable &&
           std::equal(bytes.begin(), bytes.begin() + size, other.bytes.begin());
  }
  auto operator<=>(const KeyBytes& other) const = default;
};
KeyBytes key_of(const MessageType& type, Payload payload);

/// The first fields of every message, without decoding the rest. Zeros if the payload is too short.
Header header_of(Payload payload);

/// What such a payload says of the session it belongs to; nothing if it is too short.
std::optional<std::uint64_t> token_of(Payload payload);
/// Leaves a payload that is too short as it is.
void set_token(std::span<std::uint8_t> payload, std::uint64_t token);

/// Leaves a payload that is too short as it is.
void set_sequence(std::span<std::uint8_t> payload, std::uint64_t sequence);

/// Puts the times of a message that are of its writer's clock on another, `shift_ns` ahead of it:
/// the source time of every message (1 ns at least: 0 says none), the start of a session's time.
/// A payload too short for a header stays as it is, and so do times that no codec takes, or by so
/// much, and a start time that cannot be read.
void shift_times(const MessageType& type, std::int64_t shift_ns,
                 std::vector<std::uint8_t>& payload);

}  // namespace palpate::messages
