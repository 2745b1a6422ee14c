// Messages as the payloads that travel, and recordings made of them without a bus.
#pragma once

#include <filesystem>
#include <vector>

#include "modules/messages/cdr.h"
#include "modules/recording/recorder.h"

namespace palpate::recording {

/// A message padded with zeros to a multiple of four bytes, as RTPS sends it.
template <class Message>
std::vector<std::uint8_t> cdr_of(const Message& message) {
  std::vector<std::uint8_t> payload;
  messages::write_payload(message, payload);
  payload.resize((payload.size() + 3) / 4 * 4);
  return payload;
}

/// A sample as if received on `topic` from writer number `writer`.
template <class Message>
TopicSample raw_sample(const bus::TopicOf<Message>& topic, const Message& message,
                       std::int64_t received_time_ns, std::uint8_t writer = 1) {
  TopicSample sample;
  sample.topic = bus::find_topic(topic.name);
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
