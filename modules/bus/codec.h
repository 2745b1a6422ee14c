// Translation between messages and wire types (idl/). Pure functions: no clock, no network.
#pragma once

#include "modules/messages/messages.h"

namespace palpate::idl {
class ProbeState;
class Contacts;
class ContactModel;
class NodePositions;
class SurfaceTopology;
class HapticForce;
class ModuleStatus;
class SceneDescription;
class SessionControl;
}  // namespace palpate::idl

namespace palpate::bus {

// encode: checks the message, then fills the wire object. decode: checks the wire object, then
// fills the message. Both return nullptr, or the wire name of the field that is not acceptable
// (message_checks.h); the target is then unspecified. Memory of the target is reused: no
// allocation once lists and texts of that size have been seen.

const char* encode(const ProbeState& message, idl::ProbeState& wire);
const char* encode(const Contacts& message, idl::Contacts& wire);
const char* encode(const ContactModel& message, idl::ContactModel& wire);
const char* encode(const NodePositions& message, idl::NodePositions& wire);
const char* encode(const SurfaceTopology& message, idl::SurfaceTopology& wire);
const char* encode(const HapticForce& message, idl::HapticForce& wire);
const char* encode(const ModuleStatus& message, idl::ModuleStatus& wire);
const char* encode(const SceneDescription& message, idl::SceneDescription& wire);
const char* encode(const SessionControl& message, idl::SessionControl& wire);

const char* decode(const idl::ProbeState& wire, ProbeState& message);
const char* decode(const idl::Contacts& wire, Contacts& message);
const char* decode(const idl::ContactModel& wire, ContactModel& message);
const char* decode(const idl::NodePositions& wire, NodePositions& message);
const char* decode(const idl::SurfaceTopology& wire, SurfaceTopology& message);
const char* decode(const idl::HapticForce& wire, HapticForce& message);
const char* decode(const idl::ModuleStatus& wire, ModuleStatus& message);
const char* decode(const idl::SceneDescription& wire, SceneDescription& message);
const char* decode(const idl::SessionControl& wire, SessionControl& message);

}  // namespace palpate::bus
