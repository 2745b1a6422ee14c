// Corrupts messages, and lets through what the codecs of the processes let through.
#pragma once

#include "modules/messages/messages.h"
#include "studies/fuzz/random_scene.h"

namespace palpate::fuzz {

/// Each does nothing where the fault is about another kind of message.
void corrupt(Fault fault, ProbeState& message);
void corrupt(Fault fault, Contacts& message);
void corrupt(Fault fault, ContactModel& message);

/// The name of the field for which a process would refuse the message, or nullptr.
const char* refusal(ProbeState message);
const char* refusal(Contacts message);
const char* refusal(ContactModel message);
const char* refusal(NodePositions message);
const char* refusal(HapticForce message);

}  // namespace palpate::fuzz
