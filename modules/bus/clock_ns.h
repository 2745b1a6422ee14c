// What a clock of the host says.
#pragma once

#include <chrono>
#include <cstdint>

namespace palpate::bus {

/// Since the clock's own beginning [ns].
template <class Clock>
std::int64_t clock_ns() {
  return std::chrono::nanoseconds(Clock::now().time_since_epoch()).count();
}
/// CLOCK_MONOTONIC: the same for every process of a host, never set back.
inline std::int64_t monotonic_ns() { return clock_ns<std::chrono::steady_clock>(); }

}  // namespace palpate::bus
