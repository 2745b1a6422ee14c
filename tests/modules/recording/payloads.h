// Messages as the payloads that travel, and recordings made of them without a bus.
#pragma once

#include <filesystem>
#include <vector>

#include "modules/messages/messages.h"
#include "modules/recording/recorder.h"

namespace palpate::recording {

// CDR of a valid message, by the generated wire types; padded with zeros to a multiple of four
// bytes, as RTPS sends it.
std::vector<std::uint8_t> cdr_of(const ProbeState& message);
std::vector<std::uint8_t> cdr_of(const Contacts& message);
std::vector<std::uint8_t> cdr_of(const ContactModel& message);
std::vector<std::uint8_t> cdr_of(const NodePositions& message);
std::vector<std::uint8_t> cdr_of(const SurfaceTopology& message);
std::vector<std::uint8_t> cdr_of(const HapticForce& message);
std::vector<std::uint8_t> cdr_of(const ModuleStatus& message);
std::vector<std::uint8_t> cdr_of(const SceneDescription& message);
std::vector<std::uint8_t> cdr_of(const SessionControl& message);

/// A sample as if received on `topic` from writer number `writer`.
template <class Message>
RawSample raw_sample(const bus::TopicOf<Message>& topic, const Message& message,
                     std::int64_t received_time_ns, std::uint8_t writer = 1) {
  RawSample sample;
  sample.topic = find_recorded_topic(topic.name);
  sample.writer[0] = writer;
  sample.received_time_ns = received_time_ns;
  sample.payload = cdr_of(message);
  return sample;
}

/// Node positions of one node with these values, valid.
inline NodePositions node_positions(std::uint64_t sequence, double volume, double pressure) {
  NodePositions message;
  message.header = {sequence, static_cast<std::int64_t>(sequence) * 4'000'000, 1};
  message.volume = volume;
  message.target_volume = 1e-3;
  message.pressure = pressure;
  message.positions = {0.1f, 0.2f, 0.3f};
  return message;
}

/// Probe `probe` at `position`, at session time `sim_time_ns`.
inline ProbeState probe_state(std::uint64_t sequence, std::int64_t sim_time_ns, std::uint32_t probe,
                              const Vec3& position) {
  ProbeState message;
  message.header = {sequence, sim_time_ns, 1};
  message.probe = probe;
  message.pose.position = position;
  return message;
}

}  // namespace palpate::recording
