// Tells a stage that its process was not let run for a while: what it heard last says nothing of
// the present, and what was said meanwhile it has yet to hear.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>

#include "modules/core/units.h"

namespace palpate::runtime {

class PauseWatch {
 public:
  static constexpr double kStopped = 0.2;  ///< at least, and three periods [s]

  explicit PauseWatch(double period) : limit_ns_(ns_from_seconds(std::max(kStopped, 3 * period))) {}

  /// In each cycle. @param computed_ns  Cycle::computed_ns: a long cycle is no pause
  /// @returns whether the last one was so long ago
  bool was_stopped(std::int64_t now_ns, std::int64_t computed_ns) {
    const std::int64_t before_ns = std::exchange(cycled_ns_, now_ns);
    const std::int64_t own_ns = computed_ns - std::exchange(computed_ns_, computed_ns);
    return before_ns != 0 && now_ns - before_ns - own_ns > limit_ns_;
  }

 private:
  std::int64_t limit_ns_;
  std::int64_t cycled_ns_ = 0;    ///< when the last cycle began; 0: there was none
  std::int64_t computed_ns_ = 0;  ///< until then
};

}  // namespace palpate::runtime
