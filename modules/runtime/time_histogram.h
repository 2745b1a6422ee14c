// Times, of how late a loop woke up or how long its cycles were, in logarithmic bins of fixed
// number.
#pragma once

#include <array>
#include <cstdint>

namespace palpate::runtime {

/// 64 bins per octave (1.1 % wide) from 1 µs to about 16 s. Never allocates.
class TimeHistogram {
 public:
  void add(std::int64_t time_ns);

  /// Upper edge of the bin that holds the given part of all samples [s]; 0 while empty.
  /// @param part  0 … 1, e.g. 0.999
  double quantile(double part) const;
  std::uint64_t count() const { return count_; }

 private:
  static constexpr int kBinsPerOctave = 64;
  static constexpr int kBins = 24 * kBinsPerOctave;
  static double upper_edge(int bin);  ///< [s]

  std::array<std::uint64_t, kBins> bins_{};
  std::uint64_t count_ = 0;
};

}  // namespace palpate::runtime
