// One writer without its message type: what a runtime asks before it says that it is ready.
#pragma once

#include <memory>

#include "modules/bus/raw_bus.h"

namespace palpate::bus {

class Bus;

class Output {
 public:
  Output(Bus& bus, const TopicInfo& topic);
  ~Output();
  Output(const Output&) = delete;
  Output& operator=(const Output&) = delete;

  const TopicInfo& topic() const { return topic_; }
  int matched_readers() const { return raw_->matched_readers(); }
  RawWriter& raw() { return *raw_; }

 private:
  Bus& bus_;
  TopicInfo topic_;
  std::unique_ptr<RawWriter> raw_;
};

}  // namespace palpate::bus
