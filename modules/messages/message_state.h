// A message in a StateArchive: as it travels.
#pragma once

#include "modules/core/state_archive.h"
#include "modules/messages/cdr.h"
#include "modules/messages/messages.h"

namespace palpate {

inline void exchange_state(StateArchive& archive, ContactTroubles& troubles) {
  archive(troubles.truncated, troubles.lost, troubles.unsolved);
}

}  // namespace palpate

namespace palpate::messages {

template <class Message>
void exchange_message(StateArchive& archive, Message& message) {
  std::vector<std::uint8_t> payload;
  if (!archive.reads()) write_payload(message, payload);
  archive(payload);
  if (!archive.reads()) return;
  if (read_payload(payload, message) != nullptr) throw InputError("its state is no message");
}

}  // namespace palpate::messages
