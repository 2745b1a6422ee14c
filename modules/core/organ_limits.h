// The largest organ and the longest scene: what the wire holds, and so what a scene may ask for.
#pragma once

#include <cstddef>
#include <cstdint>

namespace palpate {

inline constexpr std::size_t kMaxNodes = 200'000;
inline constexpr std::size_t kMaxTriangles = 400'000;
inline constexpr std::size_t kMaxSprings = 4'000'000;

/// Keys (organs, probes, contact models, modules) that a topic may carry at a time.
inline constexpr std::size_t kMaxKeys = 256;
inline constexpr std::size_t kMaxOrgans = kMaxKeys;
inline constexpr std::size_t kMaxProbes = kMaxKeys;

inline constexpr std::size_t kMaxTextBytes = 1u << 20;  ///< of a scene written out

/// The paper's three families of springs.
enum class SpringFamily : std::uint8_t { kStructural = 0, kBending = 1, kInner = 2 };

}  // namespace palpate
