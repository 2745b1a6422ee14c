// Samples that travel as one: a lockstep says many small ones at a time, and a message costs ten
// times what is in it.
//
// Bytes of a bundle: the samples, each filled up to whole words of 4 bytes; then of each its size
// and the number of its writer, then how many there are, all uint32, little-endian. It begins as
// its first sample does, so that who looks for key and token finds those of that one.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "modules/messages/message_types.h"

namespace palpate::bus {

/// Collects samples; keeps its memory.
class SampleBundle {
 public:
  void add(messages::Payload sample, std::uint32_t writer);
  bool empty() const { return about_.empty(); }
  /// Without the table [bytes].
  std::size_t size() const { return bytes_.size(); }
  /// All of it; until clear() nothing may be added.
  messages::Payload finish();
  void clear();

 private:
  std::vector<std::uint8_t> bytes_;
  std::vector<std::uint32_t> about_;  ///< size and writer of each
};

/// Hands out the samples of a bundle in their order.
class BundleReader {
 public:
  struct Sample {
    messages::Payload bytes;
    std::uint32_t writer = 0;
  };

  /// False, and empty, if it is none: its numbers must account for every byte.
  bool open(messages::Payload bundle);
  bool empty() const { return next_ == count_; }
  Sample next();  ///< only if not empty

 private:
  messages::Payload samples_;  ///< not yet handed out
  messages::Payload about_;
  std::size_t next_ = 0, count_ = 0;
};

}  // namespace palpate::bus
