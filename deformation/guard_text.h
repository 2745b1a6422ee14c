// What guards did, in words for the status.
#pragma once

#include <array>

#include "deformation/guard/guard_log.h"

namespace palpate::deformation {

class GuardText {
 public:
  /// Empty if none acted. Valid until the next call. Allocates nothing.
  const char* of(const GuardEvent& event);

 private:
  std::array<char, 200> text_{};
};

/// Of what guards act the one that a status says; empty if none.
/// @param of_world  of the world; comes first
const char* acting_guard(const char* of_world, double real_time_factor, bool silent_input);

}  // namespace palpate::deformation
