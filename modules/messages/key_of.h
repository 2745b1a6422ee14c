// What the key of a message is, found by its description.
#pragma once

#include <cstdint>
#include <string>

#include "modules/messages/message_types.h"

namespace palpate::messages {

/// A visitor of describe() (describe.h).
class KeyOf {
 public:
  MessageType::Key kind = MessageType::Key::kNone;
  std::string text;  ///< a number in decimals; "" without a key

  void header(const Header&) {}
  void key(const char*, std::uint32_t number) {
    kind = MessageType::Key::kNumber;
    text = std::to_string(number);
  }
  void key(const char*, const std::string& name) {
    kind = MessageType::Key::kText;
    text = name;
  }
  template <class... Any>
  void field(const Any&...) {}
  template <class... Any>
  void numbers(const Any&...) {}
  template <class... Any>
  void list(const Any&...) {}
  template <class... Any>
  void derived(const Any&...) {}
  template <class... Any>
  void require(const Any&...) {}
};

}  // namespace palpate::messages
