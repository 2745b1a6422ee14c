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

}  // namespace palpate::deformation
