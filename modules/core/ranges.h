// Loops over many alike things in ranges that threads may share out. What is summed is summed range
// by range, so that the bits do not depend on threads.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "modules/core/parallel.h"

namespace palpate {

class Ranges {
 public:
  /// Things in a range: some ten microseconds of work.
  static constexpr std::size_t kSize = 1024;
  using Sums = std::array<double, 2>;

  static constexpr std::size_t count_of(std::size_t things) { return (things + kSize - 1) / kSize; }

  /// @param runner  outlives this; none: the calling thread alone
  explicit Ranges(ChunkRunner* runner = nullptr) : runner_(runner) {}

  /// Calls body(first, last) for 0 … count.
  template <class Body>
  void each(std::size_t count, const Body& body) const {
    const auto in_range = [&](std::size_t range) {
      body(range * kSize, std::min((range + 1) * kSize, count));
    };
    const std::size_t ranges = count_of(count);
    if (runner_ != nullptr && ranges > 1) return runner_->run(ranges, in_range);
    for (std::size_t range = 0; range < ranges; ++range) in_range(range);
  }

  /// Adds up what body(first, last) returns.
  template <class Body>
  Sums sums(std::size_t count, const Body& body) {
    parts_.resize(count_of(count));
    each(count,
         [&](std::size_t first, std::size_t last) { parts_[first / kSize] = body(first, last); });
    Sums total{};
    for (const Sums& part : parts_) total[0] += part[0], total[1] += part[1];
    return total;
  }

 private:
  ChunkRunner* runner_;
  std::vector<Sums> parts_;
};

}  // namespace palpate
