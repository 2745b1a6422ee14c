// Messages as bytes: plain CDR (XCDR version 1, final types) after an encapsulation header of 4
// bytes. The types are those of idl/, the order and names of the fields those of describe.h.
#pragma once

#include "modules/messages/message_types.h"

namespace palpate::messages {

constexpr std::size_t kEncapsulationBytes = 4;

/// Replaces `payload` by the message in little endian, checked by nobody. No allocation once a
/// message of that size has been written.
template <class Message>
void write_payload(const Message& message, std::vector<std::uint8_t>& payload);

/// Fills `message` from little or big endian. No allocation once lists and texts of that size have
/// been read, and never more than the payload's own size calls for.
/// @return nullptr, or what cannot be read: the wire name of a list beyond its bounds, a word or a
/// flag that is none, or a text without its end; "payload" if bytes are missing or left over, or
/// the encapsulation is another. The message is then unspecified.
template <class Message>
const char* read_payload(Payload payload, Message& message);

/// Checked both ways: nullptr, or the wire name of the first field that is not acceptable
/// (message_checks.h).
template <class Message>
const char* encode(const Message& message, std::vector<std::uint8_t>& payload);
template <class Message>
const char* decode(Payload payload, Message& message);

}  // namespace palpate::messages
