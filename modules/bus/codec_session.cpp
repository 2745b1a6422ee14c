// Codecs of what is sent about the session and its processes.
#include "idl/ModuleStatus.h"
#include "idl/SceneDescription.h"
#include "idl/SessionControl.h"
#include "modules/bus/codec.h"
#include "modules/bus/codec_fields.h"
#include "modules/messages/message_checks.h"

namespace palpate::bus {
namespace {

void encode_input(const ModuleStatus::Input& input, idl::InputStatus& wire) {
  wire.topic(input.topic);
  wire.age_s(input.age);
  wire.received(input.received);
  wire.dropped(input.dropped);
  wire.rejected(input.rejected);
}

void decode_input(const idl::InputStatus& wire, ModuleStatus::Input& input) {
  input.topic = wire.topic();
  input.age = wire.age_s();
  input.received = wire.received();
  input.dropped = wire.dropped();
  input.rejected = wire.rejected();
}

}  // namespace

const char* encode(const ModuleStatus& message, idl::ModuleStatus& wire) {
  if (const char* field = first_invalid_field(message)) return field;
  encode_header(message.header, wire);
  wire.module_name(message.module.c_str());
  wire.state(static_cast<idl::ModuleState>(message.state));
  wire.process_id(message.process_id);
  wire.rate_hz(message.rate_hz);
  wire.nominal_rate_hz(message.nominal_rate_hz);
  wire.cycles(message.cycles);
  wire.overruns(message.overruns);
  wire.worst_lateness_s(message.worst_lateness);
  wire.busy_fraction(message.busy_fraction);
  wire.real_time_factor(message.real_time_factor);
  wire.realtime_priority(message.realtime_priority);
  wire.last_error(message.last_error);
  wire.inputs().resize(message.inputs.size());
  for (std::size_t i = 0; i < message.inputs.size(); ++i) {
    encode_input(message.inputs[i], wire.inputs()[i]);
  }
  return nullptr;
}

const char* decode(const idl::ModuleStatus& wire, ModuleStatus& message) {
  // Compared before narrowing to the message's byte.
  if (wire.state() > idl::MODULE_STOPPED) return "state";
  if (wire.inputs().size() > kMaxInputs) return "inputs";
  message.header = decode_header(wire);
  message.module = wire.module_name().c_str();
  message.state = static_cast<ModuleState>(wire.state());
  message.process_id = wire.process_id();
  message.rate_hz = wire.rate_hz();
  message.nominal_rate_hz = wire.nominal_rate_hz();
  message.cycles = wire.cycles();
  message.overruns = wire.overruns();
  message.worst_lateness = wire.worst_lateness_s();
  message.busy_fraction = wire.busy_fraction();
  message.real_time_factor = wire.real_time_factor();
  message.realtime_priority = wire.realtime_priority();
  message.last_error = wire.last_error();
  message.inputs.resize(wire.inputs().size());
  for (std::size_t i = 0; i < wire.inputs().size(); ++i) {
    decode_input(wire.inputs()[i], message.inputs[i]);
  }
  return first_invalid_field(message);
}

const char* encode(const SceneDescription& message, idl::SceneDescription& wire) {
  if (const char* field = first_invalid_field(message)) return field;
  encode_header(message.header, wire);
  wire.protocol_version(message.protocol_version);
  wire.name(message.name);
  wire.digest(message.digest);
  wire.resolved_text(message.resolved_text);
  return nullptr;
}

const char* decode(const idl::SceneDescription& wire, SceneDescription& message) {
  message.header = decode_header(wire);
  message.protocol_version = wire.protocol_version();
  message.name = wire.name();
  message.digest = wire.digest();
  message.resolved_text = wire.resolved_text();
  return first_invalid_field(message);
}

const char* encode(const SessionControl& message, idl::SessionControl& wire) {
  if (const char* field = first_invalid_field(message)) return field;
  encode_header(message.header, wire);
  wire.command(static_cast<idl::SessionCommand>(message.command));
  wire.reset_count(message.reset_count);
  wire.start_time_ns(message.start_time_ns);
  return nullptr;
}

const char* decode(const idl::SessionControl& wire, SessionControl& message) {
  if (wire.command() > idl::SESSION_STOP) return "command";
  message.header = decode_header(wire);
  message.command = static_cast<SessionCommand>(wire.command());
  message.reset_count = wire.reset_count();
  message.start_time_ns = wire.start_time_ns();
  return first_invalid_field(message);
}

}  // namespace palpate::bus
