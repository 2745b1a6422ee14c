// Typed topics over Fast DDS, behind a header that knows no DDS.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "modules/bus/topics.h"

namespace palpate::bus {

struct BusOptions {
  int domain = 0;                   ///< DDS domain id [0 … 200]
  std::string session = "default";  ///< DDS partition: sessions do not hear each other
  std::string participant_name = "palpate";
};

struct ReaderStatistics {
  std::uint64_t received = 0;
  /// Gaps in the writers' sequence numbers: lost on the way, or replaced by a newer sample of the
  /// same key before it was taken.
  std::uint64_t dropped = 0;
  std::uint64_t rejected = 0;  ///< refused by the codec: size, range, not finite
  /// Its wire name (idl/), "payload" for a sample that could not be read; nullptr if none.
  const char* last_rejected_field = nullptr;
  std::int64_t newest_source_time_ns = 0;  ///< 0 before the first
};

/// Writes messages of one topic. Fills header.sequence; where header.source_time_ns is 0, the time
/// of writing is sent (the message keeps its 0 and may be used again). Not thread-safe.
template <class Message>
class Writer {
 public:
  Writer(Writer&&) noexcept;
  Writer& operator=(Writer&&) noexcept;
  ~Writer();
  /// False if the message is not valid (nothing not finite ever leaves a process) or DDS refused
  /// it. No allocation once message sizes have been seen.
  bool write(Message& message);
  int matched_readers() const;
  /// Waits until every reader of a state topic has what was written, at most `longest` [s]: who
  /// writes and leaves at once may not be heard. False if time was up.
  bool wait_until_received(double longest);
  /// Wire name (idl/) of the field for which the last write was refused; nullptr if it was not.
  const char* refused_field() const;

 private:
  friend class Bus;
  struct Impl;
  explicit Writer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// Reads messages of one topic; poll it from the module's own loop, until take gives false. Not
/// thread-safe.
template <class Message>
class Reader {
 public:
  Reader(Reader&&) noexcept;
  Reader& operator=(Reader&&) noexcept;
  ~Reader();
  /// The next unread valid sample (the newest of its key); false if none. Invalid ones are counted
  /// and skipped. No allocation once message sizes have been seen. Never throws.
  bool take(Message& message);
  /// Waits until a sample may be there. False on timeout. timeout in seconds.
  bool wait(double timeout);
  int matched_writers() const;
  const ReaderStatistics& statistics() const;

 private:
  friend class Bus;
  struct Impl;
  explicit Reader(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// One DDS participant. Outlives its writers and readers. Its threads inherit the scheduling of the
/// thread that constructs it: set real-time priority before.
class Bus {
 public:
  /// @throws InputError for a domain outside 0 to 200, or a session that is not 1 to 64 letters,
  /// digits, '_', '-', '.', or an address in PALPATE_INTERFACES that this host does not have
  /// @throws std::runtime_error if DDS cannot start (domain in use up, no loopback, …)
  explicit Bus(const BusOptions& options);
  ~Bus();
  template <class Message>
  Writer<Message> writer(const TopicOf<Message>& topic);
  template <class Message>
  Reader<Message> reader(const TopicOf<Message>& topic);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::bus
