// How far the monotonic clock is ahead of the wall clock, by reading one between two readings of
// the other. Whoever is not let run between two readings knows only an interval that the shift lies
// in: what was known before stays as long as it is in there. So neither a pause changes it, which
// would put arrivals out of their order, nor is a wall clock that was set followed late.
#pragma once

#include <algorithm>
#include <cstdint>

namespace palpate::bus {

class WallClockShift {
 public:
  /// @param before, after  readings of the monotonic clock on either side of that of the wall [ns]
  /// @returns monotonic less wall [ns]
  std::int64_t take(std::int64_t before, std::int64_t wall, std::int64_t after) {
    shift_ns_ = std::clamp(shift_ns_, before - wall, after - wall);
    return shift_ns_;
  }

 private:
  std::int64_t shift_ns_ = 0;
};

}  // namespace palpate::bus
