// What the key of a message is, found by its description.
#pragma once

#include <cstdint>
#include <string>

#include "modules/messages/idle_visitor.h"
#include "modules/messages/message_types.h"

namespace palpate::messages {

/// A visitor of describe() (describe.h).
class KeyOf : public IdleVisitor {
 public:
  MessageType::Key kind = MessageType::Key::kNone;
  /// A number in decimals; of two numbers the first, then, unless it is 1, "/" and the second;
  /// "" without a key.
  std::string text;

  void key(const char*, std::uint32_t number) {
    if (kind == MessageType::Key::kNumber) {
      kind = MessageType::Key::kTwoNumbers;
      if (number != 1) text += "/" + std::to_string(number);
      return;
    }
    kind = MessageType::Key::kNumber;
    text = std::to_string(number);
  }
  void key(const char*, const std::string& name) {
    kind = MessageType::Key::kText;
    text = name;
  }
};

}  // namespace palpate::messages
