// One reader without its message type: what a runtime reports, and in lockstep holds back.
#pragma once

#include <limits>
#include <list>
#include <memory>
#include <utility>

#include "modules/bus/raw_bus.h"
#include "modules/core/state_archive.h"

namespace palpate::bus {

class Bus;

struct ReaderStatistics {
  std::uint64_t received = 0;
  /// Gaps in the writers' sequence numbers: lost on the way, or replaced by a newer sample of the
  /// same key before it was taken.
  std::uint64_t dropped = 0;
  std::uint64_t rejected = 0;  ///< refused by the codec: size, range, not finite
  /// Its wire name (idl/), "payload" for a sample that could not be read; nullptr if none.
  const char* last_rejected_field = nullptr;
  std::int64_t newest_source_time_ns = 0;  ///< 0 before the first
  double clock_error = 0;                  ///< of that time, see RawSample [s]
};

/// Without a horizon, samples pass as they arrived: in order for each key. With one, they are
/// handed out in the order of source time, then key, then sequence number, whatever order they
/// arrived in, and those later than the horizon wait.
class Input {
 public:
  static constexpr std::int64_t kNoHorizon = std::numeric_limits<std::int64_t>::max();

  Input(Bus& bus, const TopicInfo& topic, Keep keep = Keep::kNewest);
  ~Input();
  Input(const Input&) = delete;
  Input& operator=(const Input&) = delete;

  const TopicInfo& topic() const { return topic_; }
  const ReaderStatistics& statistics() const { return statistics_; }
  const WriterId& writer() const { return writer_; }  ///< of the last sample taken
  int matched_writers() const { return raw_->matched_writers(); }
  /// Waits until a sample may have come that nobody heard of yet; false on timeout [s]. What is
  /// held back by the horizon, or was heard by heard_until(), ends no wait.
  bool wait(double timeout) { return raw_->wait(timeout); }

  /// Samples with a later header.source_time_ns wait until the horizon has moved on.
  /// @param all_heard  nothing is to come of what it admits: nobody looks for more
  void set_horizon(std::int64_t source_time_ns, bool all_heard = false);
  /// True if of at least `keys` keys a sample of that source time or later has arrived, taken or
  /// not. Arrivals are noted from the first call on.
  bool heard_until(std::int64_t source_time_ns, std::size_t keys = 1);

  /// What waits of all that was said before `time_ns`, which has arrived. When it reads, whatever
  /// else arrives of that time was told before: it is noted, and not handed out.
  void exchange(StateArchive& archive, std::int64_t time_ns);

  // For Reader:
  /// The next sample, valid until the next call; nullptr if none.
  const RawSample* next();
  void accept(const RawSample& sample, const Header& header);
  void reject(const RawSample& sample, const char* field);

 private:
  struct Waiting {
    RawSample sample;
    Header header;
    messages::KeyBytes key;
  };

  void pull();
  /// Has something come that the horizon admits?
  bool has_admitted() const {
    return !pending_.empty() && pending_.front().header.source_time_ns <= horizon_;
  }
  Waiting& spare();
  void read_header(Waiting& arrived) const;
  void insert(std::list<Waiting>::iterator arrived);
  void note(const Waiting& waiting);
  void count(const WriterId& writer, std::uint64_t sequence);

  Bus& bus_;
  TopicInfo topic_;
  std::unique_ptr<RawReader> raw_;
  ReaderStatistics statistics_;
  WriterId writer_{};
  SequenceGaps gaps_;
  RawSample current_;

  bool gated_ = false, all_heard_ = false;
  std::int64_t horizon_ = kNoHorizon;
  std::int64_t told_before_ = std::numeric_limits<std::int64_t>::min();  ///< source time
  std::list<Waiting> pending_;  ///< in the order they will be handed out
  std::list<Waiting> spare_;    ///< memory for arrivals
  std::vector<std::pair<messages::KeyBytes, std::int64_t>> newest_;  ///< source time of each key
  std::size_t noted_ = 0;                                            ///< of these, the last
};

}  // namespace palpate::bus
