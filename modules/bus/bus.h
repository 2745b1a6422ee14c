// Typed topics over any bus: DDS (dds_bus.h) or the memory of one process (memory_bus.h). Every
// message passes its codec on both, so that rounding, bounds and checks are the same.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "modules/bus/input.h"
#include "modules/bus/output.h"
#include "modules/bus/raw_bus.h"
#include "modules/bus/topics.h"

namespace palpate::bus {

struct BusOptions {
  int domain = 0;                   ///< DDS domain id [0 … 200]
  std::string session = "default";  ///< DDS partition: sessions do not hear each other
  std::string participant_name = "palpate";
  /// What every sample must bear; else session_token() (session_token.h).
  std::optional<std::uint64_t> token = {};
  /// For lockstep: streams lose nothing either, readers get every sample in order, and what is
  /// written travels together (Bus::flush()). All processes of a session must agree.
  bool every_sample = false;
};

/// Packets that were not sound, in another participant's name, or of another session.
struct Refusals {
  std::uint64_t count = 0;
  const char* last = nullptr;  ///< why the last one was refused
};

/// Writes messages of one topic. Fills header.sequence; where header.source_time_ns is 0, the
/// bus's time of writing is sent (the message keeps its 0 and may be used again). Not thread-safe.
template <class Message>
class Writer {
 public:
  /// False if the message is not valid (nothing not finite ever leaves a process) or the bus
  /// refused it. A message that nobody reads is counted, and may be neither checked nor encoded. No
  /// allocation once message sizes have been seen.
  bool write(Message& message);
  int matched_readers() const { return output_->matched_readers(); }
  /// Waits until every reader of a state topic has what was written, at most `longest` [s]: who
  /// writes and leaves at once may not be heard. False if time was up.
  bool wait_until_received(double longest) { return output_->raw().wait_until_received(longest); }
  const WriterStatistics& statistics() const { return output_->statistics(); }

 private:
  friend class Bus;
  Writer(const Bus& bus, std::unique_ptr<Output> output) : bus_(&bus), output_(std::move(output)) {}

  const Bus* bus_;
  std::unique_ptr<Output> output_;
  std::vector<std::uint8_t> payload_;
};

/// Reads messages of one topic; poll it from the module's own loop, until take gives false. Not
/// thread-safe.
template <class Message>
class Reader {
 public:
  /// The next unread valid sample (the newest of its key, unless the bus keeps every sample or the
  /// reader a backlog); false if none. Invalid ones are counted and skipped. No allocation once
  /// message sizes have been seen. Never throws.
  bool take(Message& message);
  /// Waits until a sample may be there. False on timeout. timeout in seconds.
  bool wait(double timeout) { return input_->wait(timeout); }
  int matched_writers() const { return input_->matched_writers(); }
  const WriterId& writer() const { return input_->writer(); }  ///< of the last message taken
  const ReaderStatistics& statistics() const { return input_->statistics(); }
  Input& input() { return *input_; }

 private:
  friend class Bus;
  explicit Reader(std::unique_ptr<Input> input) : input_(std::move(input)) {}
  std::unique_ptr<Input> input_;
};

/// Hands out writers and readers, and outlives them.
class Bus {
 public:
  Bus() = default;
  Bus(const Bus&) = delete;
  Bus& operator=(const Bus&) = delete;
  virtual ~Bus() = default;

  template <class Message>
  Writer<Message> writer(const TopicOf<Message>& topic) {
    return Writer<Message>(*this, std::make_unique<Output>(*this, info_of(topic)));
  }
  template <class Message>
  Reader<Message> reader(const TopicOf<Message>& topic, Keep keep = Keep::kNewest) {
    return Reader<Message>(std::make_unique<Input>(*this, info_of(topic), keep));
  }

  /// @throws std::runtime_error if the bus cannot
  virtual std::unique_ptr<RawWriter> raw_writer(const TopicInfo& topic) = 0;
  virtual std::unique_ptr<RawReader> raw_reader(const TopicInfo& topic, Keep keep) = 0;

  /// Sends what waits to travel together, topic by topic in the order their writers were made: what
  /// others wait for comes first. Who writes streams with every_sample calls it before it waits for
  /// anything; while it waits, what there was no room for goes.
  virtual void flush() {}

  /// All readers alive, in the order they were made.
  std::span<Input* const> inputs() const { return inputs_; }
  std::span<Output* const> outputs() const { return outputs_; }  ///< the same of writers

  /// Packets from outside that were not let in; none on a bus that has no outside.
  virtual Refusals packets_refused() const { return {}; }

  /// Which other host's clock is not known, in a sentence; empty if none is missed. What comes from
  /// there is held back. The text holds as long as the bus.
  virtual const char* clock_trouble() const { return ""; }

  /// What stamps messages, in ns; CLOCK_MONOTONIC unless set.
  void set_clock(std::function<std::int64_t()> now_ns) { clock_ = std::move(now_ns); }
  std::int64_t now_ns() const;

 private:
  friend class Input;
  friend class Output;
  std::vector<Input*> inputs_;
  std::vector<Output*> outputs_;
  std::function<std::int64_t()> clock_;
};

}  // namespace palpate::bus
