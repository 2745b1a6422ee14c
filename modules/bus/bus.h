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
  std::uint64_t dropped = 0;   ///< gaps in the writers' sequence numbers
  std::uint64_t rejected = 0;  ///< refused by the codec: size, range, not finite
  std::int64_t newest_source_time_ns = 0;  ///< 0 before the first
};

/// Writes messages of one topic. Fills header.sequence. Not thread-safe.
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

 private:
  friend class Bus;
  struct Impl;
  explicit Writer(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// Reads messages of one topic; poll it from the module's own loop.
template <class Message>
class Reader {
 public:
  Reader(Reader&&) noexcept;
  Reader& operator=(Reader&&) noexcept;
  ~Reader();
  /// The next unread valid sample; false if none. Invalid ones are counted and skipped.
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

/// One DDS participant. Outlives its writers and readers.
class Bus {
 public:
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
