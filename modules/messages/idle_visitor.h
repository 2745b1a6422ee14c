// A visitor of describe() (describe.h) to begin others with.
#pragma once

#include "modules/messages/messages.h"

namespace palpate::messages {

/// Does nothing with what it is shown.
struct IdleVisitor {
  void header(const Header&) {}
  template <class... Any>
  void key(const Any&...) {}
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
