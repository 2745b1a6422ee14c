#include "modules/bus/sequence_gaps.h"

#include <algorithm>

namespace palpate::bus {

std::uint64_t SequenceGaps::Entry::missing() const {
  const std::uint64_t expected = last - first + 1;
  return expected > received ? expected - received : 0;
}

SequenceGaps::Entry& SequenceGaps::entry_of(const WriterId& writer, std::uint64_t sequence) {
  const auto end = entries_.begin() + static_cast<std::ptrdiff_t>(used_);
  const auto known =
      std::find_if(entries_.begin(), end, [&](const Entry& e) { return e.writer == writer; });
  if (known != end) return *known;

  Entry* entry;
  if (used_ < entries_.size()) {
    entry = &entries_[used_++];
  } else {
    entry = &entries_[oldest_];
    oldest_ = (oldest_ + 1) % entries_.size();
    missing_of_forgotten_ += entry->missing();
  }
  *entry = {writer, sequence, sequence, 0};
  return *entry;
}

void SequenceGaps::count(const WriterId& writer, std::uint64_t sequence) {
  Entry& entry = entry_of(writer, sequence);
  if (sequence < entry.first) return;  // from before we joined
  entry.last = std::max(entry.last, sequence);
  ++entry.received;
}

std::uint64_t SequenceGaps::dropped() const {
  std::uint64_t sum = missing_of_forgotten_;
  for (std::size_t i = 0; i < used_; ++i) sum += entries_[i].missing();
  return sum;
}

}  // namespace palpate::bus
