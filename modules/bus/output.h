// One writer without its message type: what a runtime asks before it says that it is ready, and
// what a watcher asks of messages that never left.
#pragma once

#include <memory>

#include "modules/bus/raw_bus.h"
#include "modules/core/state_archive.h"

namespace palpate::bus {

class Bus;

struct WriterStatistics {
  std::uint64_t refused = 0;  ///< by the codec, thus not written: size, range, not finite
  const char* last_refused_field = nullptr;  ///< its wire name (idl/); nullptr if none
};

class Output {
 public:
  Output(Bus& bus, const TopicInfo& topic);
  ~Output();
  Output(const Output&) = delete;
  Output& operator=(const Output&) = delete;

  const TopicInfo& topic() const { return topic_; }
  int matched_readers() const { return raw_->matched_readers(); }
  RawWriter& raw() { return *raw_; }
  const WriterStatistics& statistics() const { return statistics_; }

  /// Goes on with the numbers of another one.
  void exchange(StateArchive& archive) { archive(sequence_); }

  // For Writer:
  std::uint64_t next_sequence() const { return sequence_ + 1; }
  void count() { ++sequence_; }
  void refuse(const char* field) {
    ++statistics_.refused;
    statistics_.last_refused_field = field;
  }

 private:
  Bus& bus_;
  TopicInfo topic_;
  std::unique_ptr<RawWriter> raw_;
  WriterStatistics statistics_;
  std::uint64_t sequence_ = 0;  ///< of the last sample
};

}  // namespace palpate::bus
