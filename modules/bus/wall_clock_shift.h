// How far the monotonic clock is ahead of the wall clock, by reading one between two readings of
// the other. Whoever is not let run between two readings knows only an interval that the shift lies
// in: what was known before stays as long as it is in there. So neither a pause changes it, which
// would put arrivals out of their order, nor is a wall clock that was set followed late. What
// arrived before it was set, and is read after, has a stamp that is wrong by as much: it came after
// nothing waited, and before now.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

namespace palpate::bus {

class WallClockShift {
 public:
  /// @param before, after  readings of the monotonic clock on either side of that of the wall [ns]
  /// @returns monotonic less wall [ns]
  std::int64_t take(std::int64_t before, std::int64_t wall, std::int64_t after) {
    shift_ns_ = std::clamp(shift_ns_, before - wall, after - wall);
    return shift_ns_;
  }

  /// @param stamp  of an arrival, by the wall clock; the others as take() has them
  /// @returns when that was, by the monotonic clock
  std::int64_t arrival(std::int64_t stamp, std::int64_t before, std::int64_t wall,
                       std::int64_t after) {
    const std::int64_t time = stamp + take(before, wall, after);
    const std::int64_t earliest = std::max(nothing_waited_ns_, last_ns_);
    if (earliest == kNever) return last_ns_ = std::min(time, after);
    const bool was_set = time > after || time < nothing_waited_ns_ - kHandedOnWithinNs;
    return last_ns_ = was_set ? earliest : time;
  }
  /// Nobody's arrival is left to be read. @param now  by the monotonic clock
  void nothing_waits(std::int64_t now) { nothing_waited_ns_ = now; }

 private:
  /// From its stamp until it can be read.
  static constexpr std::int64_t kHandedOnWithinNs = 100'000'000;
  static constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::min() / 2;

  std::int64_t shift_ns_ = 0;
  std::int64_t nothing_waited_ns_ = kNever, last_ns_ = kNever;
};

}  // namespace palpate::bus
