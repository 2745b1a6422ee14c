#include "haptics/devices/driver_clock.h"

#include <algorithm>

namespace palpate::haptics {

std::optional<std::int64_t> DriverClock::hear(std::int64_t stamp_ns, std::int64_t now_ns) {
  if (stamp_ns <= 0) return now_ns;
  if (stamp_ns <= newest_stamp_) {
    ++old_;
    return std::nullopt;
  }
  newest_stamp_ = stamp_ns;
  return std::min(now_ns, stamp_ns + offset(now_ns - stamp_ns, now_ns));
}

void DriverClock::forget() {
  newest_stamp_ = 0;
  least_ = least_before_ = kNone;
}

std::int64_t DriverClock::offset(std::int64_t difference, std::int64_t now_ns) {
  if (least_ == kNone || now_ns - window_began_ns_ > kWindow) {
    least_before_ = least_;
    least_ = kNone;
    window_began_ns_ = now_ns;
  }
  least_ = std::min(least_, difference);
  const std::int64_t least = std::min(least_, least_before_);
  return least >= -kAhead && least <= kSameClock ? 0 : least;
}

}  // namespace palpate::haptics
