// Counts the samples that writers numbered but a reader never got.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "modules/core/organ_limits.h"

namespace palpate::bus {

using WriterId = std::array<unsigned char, 16>;

/// Numbers of one writer's samples, counted from the first that was heard. Samples of different
/// keys may come out of order; a late one closes its gap again.
class SequenceNumbers {
 public:
  /// Nobody has missed so many in a row: 28 hours of a thousand a second. Where a number leaps
  /// further, the writer counts anew from there, or lies.
  static constexpr std::uint64_t kFarthestLeap = 100'000'000;

  void count(std::uint64_t sequence);
  std::uint64_t missing() const { return missing_before_ + missing_since(); }

 private:
  std::uint64_t missing_since() const;

  std::uint64_t first_ = 0, last_ = 0, received_ = 0;  ///< since the last leap
  std::uint64_t missing_before_ = 0;
};

/// Gaps in the sequence numbers of several writers. No allocation.
class SequenceGaps {
 public:
  /// Known at a time: a writer for each key. Of more the one that was silent longest makes room.
  static constexpr std::size_t kMostWriters = kMaxKeys;

  void count(const WriterId& writer, std::uint64_t sequence);
  std::uint64_t dropped() const;

 private:
  struct Entry {
    WriterId writer{};
    SequenceNumbers numbers;
    std::uint64_t heard_at = 0;  ///< by counted_
  };
  Entry& entry_of(const WriterId& writer);
  Entry& new_entry();

  std::array<Entry, kMostWriters> entries_;
  std::size_t used_ = 0;
  std::uint64_t counted_ = 0;  ///< samples
  std::uint64_t missing_of_forgotten_ = 0;
};

}  // namespace palpate::bus
