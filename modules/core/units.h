// The length units accepted at the border, and nanoseconds. Inside, everything is SI.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace palpate {

inline constexpr std::int64_t kNanosecondsPerSecond = 1'000'000'000;

/// Metres per unit for "m", "dm", "cm", "mm", "um", "in".
/// @throws InputError for anything else, listing what is allowed.
double metres_per_unit(std::string_view unit);

inline double seconds_from_ns(std::int64_t ns) { return 1e-9 * static_cast<double>(ns); }

/// Rounded to the nearest nanosecond.
inline std::int64_t ns_from_seconds(double seconds) {
  return static_cast<std::int64_t>(seconds * 1e9 + (seconds < 0 ? -0.5 : 0.5));
}

}  // namespace palpate
