// Counts the samples that writers numbered but a reader never got.
#pragma once

#include <array>
#include <cstdint>

namespace palpate::bus {

using WriterId = std::array<unsigned char, 16>;

/// Gaps in the sequence numbers of several writers, counted from the first sample of each. Samples
/// of different keys may come out of order; a late one closes its gap again. No allocation.
class SequenceGaps {
 public:
  void count(const WriterId& writer, std::uint64_t sequence);
  std::uint64_t dropped() const;

 private:
  struct Entry {
    WriterId writer{};
    std::uint64_t first = 0, last = 0, received = 0;
    std::uint64_t missing() const;
  };
  Entry& entry_of(const WriterId& writer, std::uint64_t sequence);

  std::array<Entry, 32> entries_;  // writers known at a time; the oldest makes room
  std::size_t used_ = 0;
  std::size_t oldest_ = 0;
  std::uint64_t missing_of_forgotten_ = 0;
};

}  // namespace palpate::bus
