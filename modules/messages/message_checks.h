// What a message must satisfy to leave or to enter a process.
#pragma once

#include "modules/messages/message_types.h"

namespace palpate::messages {

/// Far beyond what anything measures in SI units, and far from where squares overflow.
inline constexpr double kMaxMagnitude = 1e30;

/// The wire name of the first field that is not acceptable (not finite, beyond kMaxMagnitude, out
/// of range, too long, an index beyond its list), or nullptr. Rules and names are those of
/// describe.h.
template <class Message>
const char* first_invalid_field(const Message& message);

}  // namespace palpate::messages
