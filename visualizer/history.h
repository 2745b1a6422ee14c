// The newest values of one quantity over simulated time, for a plot.
#pragma once

#include <cstddef>
#include <vector>

namespace palpate::visualizer {

/// Ring buffer of (time, value). A time before the newest one means that the session was reset:
/// the history starts again.
class History {
 public:
  struct Sample {
    double time = 0;  ///< simulated [s]
    double value = 0;
  };

  /// @param capacity  ≥ 1 samples
  /// @param spacing  samples closer than this to the one before are merged with it: the value
  ///        larger in magnitude stays, so that a short peak remains visible [s]
  explicit History(std::size_t capacity = 2048, double spacing = 0.005)
      : capacity_(capacity), spacing_(spacing) {
    ring_.reserve(capacity);
  }

  void push(double time, double value) {
    if (!empty() && time < newest().time) clear();
    if (!empty() && time - slot_start_ < spacing_) {
      Sample& last = ring_[index(size() - 1)];
      if (value * value >= last.value * last.value) last.value = value;
      last.time = time;
      return;
    }
    slot_start_ = time;
    if (ring_.size() < capacity_) {
      ring_.push_back({time, value});
    } else {
      ring_[oldest_] = {time, value};
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
