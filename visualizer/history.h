// The newest values of one quantity over simulated time, for a plot.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace palpate::visualizer {

/// Ring buffer of slots of time, each with all that came in it: its least, greatest and newest
/// value. So a peak of one sample stays, however few slots are drawn. A time before the newest one
/// means that the session was reset: the history starts again.
class History {
 public:
  struct Sample {
    double time = 0;   ///< of the slot's newest, simulated [s]
    double value = 0;  ///< newest
    double least = 0, greatest = 0;
  };

  /// @param capacity  ≥ 1 samples
  /// @param spacing  length of a slot [s]
  explicit History(std::size_t capacity = 2048, double spacing = 0.005)
      : capacity_(capacity), spacing_(spacing) {
    ring_.reserve(capacity);
  }

  void push(double time, double value) {
    if (!empty() && time < newest().time) clear();
    if (!empty() && time - slot_start_ < spacing_) {
      Sample& last = ring_[index(size() - 1)];
      last = {time, value, std::min(last.least, value), std::max(last.greatest, value)};
      return;
    }
    slot_start_ = time;
    if (ring_.size() < capacity_) {
      ring_.push_back({time, value, value, value});
    } else {
      ring_[oldest_] = {time, value, value, value};
      oldest_ = (oldest_ + 1) % capacity_;
    }
  }

  void clear() {
    ring_.clear();
    oldest_ = 0;
  }

  bool empty() const { return ring_.empty(); }
  std::size_t size() const { return ring_.size(); }
  const Sample& at(std::size_t i) const { return ring_[index(i)]; }  ///< 0 = oldest
  const Sample& newest() const { return at(size() - 1); }            ///< not if empty

 private:
  std::size_t index(std::size_t i) const { return (oldest_ + i) % ring_.size(); }

  std::size_t capacity_;
  double spacing_;
  double slot_start_ = 0;
  std::size_t oldest_ = 0;
  std::vector<Sample> ring_;
};

}  // namespace palpate::visualizer
