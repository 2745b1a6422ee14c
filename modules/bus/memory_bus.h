// The bus within one process and one thread: no clock, no socket, the same contract as DdsBus.
#pragma once

#include <list>
#include <map>
#include <vector>

#include "modules/bus/bus.h"

namespace palpate::bus {

/// What is written is at once with every reader. Not thread-safe: nobody else can write while a
/// reader waits, so waiting never takes time.
class MemoryBus : public Bus {
 public:
  explicit MemoryBus(bool every_sample = false) : every_sample_(every_sample) {}

  std::unique_ptr<RawWriter> raw_writer(const TopicInfo& topic) override;
  std::unique_ptr<RawReader> raw_reader(const TopicInfo& topic, Keep keep) override;

 private:
  class MemoryWriter;
  class MemoryReader;
  struct Endpoints {
    std::vector<MemoryWriter*> writers;
    std::vector<MemoryReader*> readers;
  };

  bool every_sample_;
  std::uint64_t writer_count_ = 0;  ///< ever made
  std::map<std::string, Endpoints, std::less<>> topics_;
};

}  // namespace palpate::bus
