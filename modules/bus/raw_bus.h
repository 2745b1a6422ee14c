// A bus carries payloads (messages as bytes, modules/messages/cdr.h); the typed layer over it is
// bus.h.
#pragma once

#include <cstdint>
#include <vector>

#include "modules/bus/sequence_gaps.h"
#include "modules/bus/topics.h"

namespace palpate::bus {

/// Fifty milliseconds of the fastest loop (4 kHz), and some more [samples].
inline constexpr int kBacklogDepth = 256;
/// A second of it: what a socket holds and hands out at once to a process that was not let run.
inline constexpr int kLongBacklogDepth = 4096;

/// Which samples wait for a reader that is busy.
enum class Keep {
  kNewest,   ///< of each key, unless the bus keeps every sample
  kBacklog,  ///< of each key the newest kBacklogDepth
  /// Of each key the newest kLongBacklogDepth: of small messages only, it is memory.
  kLongBacklog,
};

struct RawSample {
  WriterId writer{};                  ///< unique among all that ever were
  std::int64_t received_time_ns = 0;  ///< by the monotonic clock, or the memory bus's own [ns]
  /// How well the writer's clock is known, on whose times the payload's were put; 0 of this host
  /// [s]
  double clock_error = 0;
  std::vector<std::uint8_t> payload;
};

/// Writes payloads of one topic. Not thread-safe.
class RawWriter {
 public:
  virtual ~RawWriter() = default;
  /// False if the bus refused it.
  virtual bool write(messages::Payload payload) = 0;
  virtual int matched_readers() const = 0;
  /// Whether there are some, as far as it was heard: asked for each bundle.
  virtual bool has_readers() const { return matched_readers() > 0; }
  /// False where it is known, without asking, that nobody gets what is written now.
  virtual bool is_read() const { return true; }
  /// Waits until every reader of a reliable topic has what was written, at most `longest` [s].
  virtual bool wait_until_received(double longest) = 0;
};

/// Reads payloads of one topic. Not thread-safe.
class RawReader {
 public:
  virtual ~RawReader() = default;
  /// The next unread sample; false if none. `sample` gives its memory for it.
  virtual bool take(RawSample& sample) = 0;
  /// Waits until a sample may be there; false on timeout [s].
  virtual bool wait(double timeout) = 0;
  /// Those that travel together (Bus::flush()) count as one.
  virtual int matched_writers() const = 0;
};

}  // namespace palpate::bus
