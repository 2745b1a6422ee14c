// The form of the words by which participants prove who they are. Debian's Fast DDS 2.9.1 makes
// room for as many of their parts as a message says it has, and ends the process when there is
// none.
#pragma once

#include <cstdint>
#include <span>

namespace palpate::bus {

/// The built-in writer of such words, which are never encrypted.
inline constexpr std::uint32_t kAuthenticationWriter = 0x000201c3;

/// Whether all that a ParticipantGenericMessage says it holds is there (DDS Security 1.1, section
/// 7.4.3.3): identities and keys, its class, and lists of named strings and octets.
/// @param payload  with its encapsulation
bool is_generic_message(std::span<const std::uint8_t> payload);

}  // namespace palpate::bus
