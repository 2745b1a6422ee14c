// Samples of all topics as the bytes that travel (CDR with its encapsulation header), to and from
// a session. Transport, partition and delivery are those of modules/bus.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "modules/bus/bus.h"
#include "modules/recording/recorded_topics.h"

namespace palpate::recording {

/// Which writer a sample came from; unique among all that ever were.
using WriterId = std::array<std::uint8_t, 16>;

struct RawSample {
  const RecordedTopic* topic = nullptr;
  WriterId writer{};
  std::int64_t received_time_ns = 0;  ///< when it arrived, monotonic clock of this host [ns]
  std::vector<std::uint8_t> payload;
};

/// Hears every topic of a session.
class RawReader {
 public:
  /// @throws InputError, std::runtime_error as bus::Bus does
  explicit RawReader(const bus::BusOptions& options);
  ~RawReader();

  /// All samples that have arrived and were not taken, in the order they arrived. The samples keep
  /// their memory for the next call; valid until then.
  std::span<const RawSample> take_all();

  /// Writers heard of, of all topics.
  int matched_writers() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Writes recorded samples into a session.
class RawWriter {
 public:
  /// @throws InputError, std::runtime_error as bus::Bus does
  explicit RawWriter(const bus::BusOptions& options);
  ~RawWriter();

  /// False if DDS refused it, or the payload is not of the topic's type.
  bool write(const RecordedTopic& topic, std::span<const std::uint8_t> payload);

  /// Readers of a topic.
  int matched_readers(const RecordedTopic& topic) const;

  /// Waits until every reader of the reliable topics has all samples. timeout in seconds.
  void wait_for_acknowledgments(double timeout);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::recording
