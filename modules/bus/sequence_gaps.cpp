#include "modules/bus/sequence_gaps.h"

#include <algorithm>

namespace palpate::bus {

void SequenceNumbers::count(std::uint64_t sequence) {
  const bool leaps = received_ > 0 && sequence > last_ && sequence - last_ > kFarthestLeap;
  if (leaps) missing_before_ += missing_since();
  if (leaps || received_ == 0) {
    first_ = last_ = sequence;
    received_ = 1;
    return;
  }
  if (sequence < first_) return;  // from before we joined
  last_ = std::max(last_, sequence);
  ++received_;
}

std::uint64_t SequenceNumbers::missing_since() const {
  if (received_ == 0) return 0;
  const std::uint64_t expected = last_ - first_ + 1;
  return expected > received_ ? expected - received_ : 0;
}

SequenceGaps::Entry& SequenceGaps::entry_of(const WriterId& writer) {
  const auto end = entries_.begin() + static_cast<std::ptrdiff_t>(used_);
  const auto known =
      std::find_if(entries_.begin(), end, [&](const Entry& e) { return e.writer == writer; });
  if (known != end) return *known;
  Entry& entry = new_entry();
  entry.writer = writer;
  return entry;
}

SequenceGaps::Entry& SequenceGaps::new_entry() {
  if (used_ < entries_.size()) return entries_[used_++];
  Entry& silent = *std::ranges::min_element(entries_, {}, &Entry::heard_at);
  missing_of_forgotten_ += silent.numbers.missing();
  silent = {};
  return silent;
}

void SequenceGaps::count(const WriterId& writer, std::uint64_t sequence) {
  Entry& entry = entry_of(writer);
  entry.heard_at = ++counted_;
  entry.numbers.count(sequence);
}

std::uint64_t SequenceGaps::dropped() const {
  std::uint64_t sum = missing_of_forgotten_;
  for (std::size_t i = 0; i < used_; ++i) sum += entries_[i].numbers.missing();
  return sum;
}

}  // namespace palpate::bus
