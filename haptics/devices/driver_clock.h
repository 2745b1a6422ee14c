// When an outside driver sampled, on this host's clock, from the stamps that it gives on its own.
//
// A stamp of the same clock (a driver on this host that stamps with CLOCK_MONOTONIC) is as old on
// hearing as its way here took: between 0 and kSameClock. Anything else is another clock. Its
// offset is the smallest difference hearing − stamp heard within the last kWindow to 2 kWindow:
// the sample that came fastest is taken to have come at once. So of a delay that never changes
// nothing is seen, of one that changes what it is above its least; and a clock that runs
// differently (50 ppm: 0.1 ms in 2 s) is followed.
#pragma once

#include <cstdint>
#include <limits>
#include <optional>

#include "modules/core/state_archive.h"

namespace palpate::haptics {

class DriverClock {
 public:
  static constexpr std::int64_t kSameClock = 100'000'000;  ///< [ns]
  /// A sample may be stamped after the cycle began that hears it [ns].
  static constexpr std::int64_t kAhead = 2'000'000;
  static constexpr std::int64_t kWindow = 1'000'000'000;  ///< [ns]

  /// A sample stamped `stamp_ns` by its driver (0 or less: not at all) is heard at `now_ns`.
  /// @returns when it was sampled, on the clock of `now_ns` and no later; nothing for a stamp not
  ///          later than the one before: the sample is old
  std::optional<std::int64_t> hear(std::int64_t stamp_ns, std::int64_t now_ns);

  /// Begins anew: another driver may come, or the same one started again.
  void forget();

  std::uint64_t old() const { return old_; }  ///< samples that came too late, since construction

  void exchange(StateArchive& archive) {
    archive(newest_stamp_, window_began_ns_, least_, least_before_, old_);
  }

 private:
  static constexpr std::int64_t kNone = std::numeric_limits<std::int64_t>::max();
  std::int64_t offset(std::int64_t difference, std::int64_t now_ns);

  std::int64_t newest_stamp_ = 0;
  std::int64_t window_began_ns_ = 0;
  std::int64_t least_ = kNone, least_before_ = kNone;  ///< of this window and of the one before
  std::uint64_t old_ = 0;
};

}  // namespace palpate::haptics
