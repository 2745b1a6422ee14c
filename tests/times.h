// Times that tests count in.
#pragma once

#include <cstdint>

namespace palpate {

inline constexpr std::int64_t kMs = 1'000'000, kSecond = 1'000 * kMs;  ///< [ns]
inline constexpr double kTick = 1e-3;                                  ///< of the haptic loop [s]

}  // namespace palpate
