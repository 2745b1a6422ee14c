// Valid messages with random content, and comparison of two messages bit by bit.
#pragma once

#include <random>

#include "modules/messages/messages.h"

namespace palpate::bus::testing {

using Random = std::mt19937_64;

void fill(Random& random, ProbeState& message);
void fill(Random& random, Contacts& message);
void fill(Random& random, ContactModel& message);
void fill(Random& random, NodePositions& message);
void fill(Random& random, SurfaceTopology& message);
void fill(Random& random, HapticForce& message);
void fill(Random& random, ModuleStatus& message);
void fill(Random& random, SceneDescription& message);
void fill(Random& random, SessionControl& message);

template <class Message>
Message random_message(Random& random) {
  Message message;
  fill(random, message);
  return message;
}

/// A topology of that many surface nodes, triangles and springs, all indices in range.
SurfaceTopology random_topology(Random& random, std::size_t nodes, std::size_t triangles,
                                std::size_t springs);

bool equal(const ProbeState& a, const ProbeState& b);
bool equal(const Contacts& a, const Contacts& b);
bool equal(const ContactModel& a, const ContactModel& b);
bool equal(const NodePositions& a, const NodePositions& b);
bool equal(const SurfaceTopology& a, const SurfaceTopology& b);
bool equal(const HapticForce& a, const HapticForce& b);
bool equal(const ModuleStatus& a, const ModuleStatus& b);
bool equal(const SceneDescription& a, const SceneDescription& b);
bool equal(const SessionControl& a, const SessionControl& b);

}  // namespace palpate::bus::testing
