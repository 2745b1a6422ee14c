// What a message must satisfy to leave or to enter a process.
#pragma once

#include "modules/messages/messages.h"

namespace palpate::bus {

// Each returns the wire name of the first field that is not acceptable (not finite, out of range,
// too long, an index beyond its list), or nullptr. Names are as in idl/.

/// Allowed deviation of a quaternion's or normal's length and of a barycentric sum from 1.
/// Generous to senders that normalize in single precision (rounding 6e-8 per component).
inline constexpr double kUnitTolerance = 1e-6;
/// Allowed asymmetry and negative eigenvalue of a stiffness, relative to its largest entry.
inline constexpr double kStiffnessTolerance = 1e-6;
inline constexpr std::size_t kMaxNameBytes = 64;  ///< of a module and a topic

const char* first_invalid_field(const ProbeState& message);
const char* first_invalid_field(const Contacts& message);
const char* first_invalid_field(const ContactModel& message);
const char* first_invalid_field(const NodePositions& message);
const char* first_invalid_field(const SurfaceTopology& message);
const char* first_invalid_field(const HapticForce& message);
const char* first_invalid_field(const ModuleStatus& message);
const char* first_invalid_field(const SceneDescription& message);
const char* first_invalid_field(const SessionControl& message);

}  // namespace palpate::bus
