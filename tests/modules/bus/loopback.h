// Buses of their own for each test, and waiting on conditions with a deadline.
#pragma once

#include <unistd.h>

#include <atomic>
#include <string>

#include "modules/bus/dds_bus.h"
#include "tests/modules/own_domain.h"
#include "tests/modules/waiting.h"

namespace palpate::bus::testing {

using palpate::testing::kDeadline;
using palpate::testing::wait_until;

/// Options that no other test shares: a domain of the process, session from a count.
inline BusOptions own_options() {
  static std::atomic<int> count{0};
  BusOptions options;
  options.domain = palpate::testing::own_domain(1);  // below the ephemeral ports
  options.session = std::to_string(getpid()).append("_").append(std::to_string(++count));
  return options;
}

/// A writer and a reader of one topic on two buses, matched.
template <class Message>
struct Pair {
  explicit Pair(const TopicOf<Message>& topic, const BusOptions& options = own_options())
      : writer_bus(options),
        reader_bus(options),
        writer(writer_bus.writer(topic)),
        reader(reader_bus.reader(topic)) {
    matched =
        wait_until([&] { return writer.matched_readers() == 1 && reader.matched_writers() == 1; });
  }

  DdsBus writer_bus, reader_bus;
  Writer<Message> writer;
  Reader<Message> reader;
  bool matched = false;
};

/// Waits for the next sample.
template <class Message>
bool take_soon(Reader<Message>& reader, Message& message, double deadline = kDeadline) {
  return wait_until([&] { return reader.take(message); }, deadline);
}

}  // namespace palpate::bus::testing
