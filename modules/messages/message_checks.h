// What a message must satisfy to leave or to enter a process.
#pragma once

#include "modules/messages/message_types.h"

namespace palpate::messages {

/// Far beyond what anything measures in SI units, and far from where squares overflow.
inline constexpr double kMaxMagnitude = 1e30;
/// Of numbers that count, a writer's samples too: a million a second for thirty years.
inline constexpr std::uint64_t kMaxCount = 1'000'000'000'000'000;
/// Of times and their negatives: 146 years. The difference of two is a time that fits [ns].
inline constexpr std::int64_t kMaxTimeNs = std::int64_t{1} << 62;

/// The wire name of the first field that is not acceptable (not finite, beyond what is sensible,
/// out of range, too long, an index beyond its list), or nullptr. Rules and names are those of
/// describe.h.
template <class Message>
const char* first_invalid_field(const Message& message);

}  // namespace palpate::messages
