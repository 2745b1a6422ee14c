// Sessions on each bus, for what holds of any: one contract, two buses, one of them heard in three
// ways.
#pragma once

#include <catch2/catch.hpp>
#include <memory>

#include "modules/bus/memory_bus.h"
#include "tests/modules/bus/loopback.h"

namespace palpate::bus::testing {

// Two ends of one session: two participants, or one memory.
struct DdsSession {
  explicit DdsSession(bool every_sample = false) : options(own_options()) {
    options.every_sample = every_sample;
    near = std::make_unique<DdsBus>(options);
    far = std::make_unique<DdsBus>(options);
  }
  Bus& writers() { return *near; }
  Bus& readers() { return *far; }
  static constexpr int kStreamsOfTwoWriters = 1;  ///< with every sample they travel together
  BusOptions options;
  std::unique_ptr<DdsBus> near, far;
};

// As a recorder hears.
struct GatheredSession : DdsSession {
  explicit GatheredSession(bool every_sample = false) : DdsSession(every_sample) {
    far = std::make_unique<DdsBus>(options, Arrivals::kGathered);
  }
};

// As the processes of a lockstep hear: with every sample, past DDS.
struct PolledSession : DdsSession {
  explicit PolledSession(bool every_sample = false) : DdsSession(every_sample) {
    if (every_sample) near = std::make_unique<DdsBus>(options, Arrivals::kPolled);
    far = std::make_unique<DdsBus>(options, Arrivals::kPolled);
  }
};

struct MemorySession {
  explicit MemorySession(bool every_sample = false) : bus(every_sample) {}
  Bus& writers() { return bus; }
  Bus& readers() { return bus; }
  static constexpr int kStreamsOfTwoWriters = 2;
  MemoryBus bus;
};

template <class Message>
void match(const Writer<Message>& writer, const Reader<Message>& reader, int writers = 1) {
  // Both look, even if one is not there yet: who is polled hears as it looks.
  REQUIRE(wait_until([&] {
    const bool is_read = writer.matched_readers() == 1;
    return reader.matched_writers() == writers && is_read;
  }));
}

inline ProbeState state_at(std::int64_t source_time_ns, std::uint32_t probe = 0) {
  ProbeState state;
  state.header.source_time_ns = source_time_ns;
  state.probe = probe;
  return state;
}

// Everything that arrives until `count` samples came; the writer waits for it in turns, as there is
// no room for all of it on the way.
template <class Message>
std::vector<Message> take_all(Writer<Message>& writer, Reader<Message>& reader, std::size_t count) {
  std::vector<Message> taken;
  Message message;
  wait_until([&] {
    writer.wait_until_received(0.001);
    while (reader.take(message)) taken.push_back(message);
    return taken.size() >= count;
  });
  return taken;
}

}  // namespace palpate::bus::testing

#define PALPATE_BOTH_BUSES DdsSession, GatheredSession, PolledSession, MemorySession
