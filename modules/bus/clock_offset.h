// How far another host's clock is from this one's, by messages that cross (Mills, RFC 5905, section
// 8).
//
// Ours is sent at t₁ (our clock) and heard at t₂ (theirs), theirs is sent at t₃ and heard at t₄.
// What is sent is heard later, so the offset θ = ours − theirs lies in [t₁ − t₂, t₄ − t₃], whatever
// the ways take: an interval as wide as both ways together, δ = (t₄ − t₁) − (t₃ − t₂). Its middle
// is right if both take as long. The narrowest interval of the last seconds holds (the ways are
// shortest where nothing waits), widened by what two clocks can have drifted since.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>

namespace palpate::bus {

/// The four stamps [ns].
struct RoundTrip {
  std::int64_t sent_here = 0, received_there = 0, sent_there = 0, received_here = 0;
};

class ClockOffset {
 public:
  /// Linux speeds a monotonic clock up or slows it down by at most 500 ppm (adjtimex(2)); there are
  /// two, beside what their crystals differ by, 100 ppm and less.
  static constexpr double kMostDrift = 1.1e-3;
  static constexpr std::int64_t kBlock = 1'000'000'000;  ///< the best of each is kept [ns]
  static constexpr std::size_t kBlocks = 16;
  /// So many intervals in a row that do not meet what is known: the clock was set, or stood still.
  static constexpr int kJumpAfter = 3;

  struct Estimate {
    std::int64_t offset_ns = 0;  ///< ours − theirs
    double error = 0;            ///< it is right within that [s]
  };

  /// A trip of negative δ cannot have been, and is left out.
  void add(const RoundTrip& trip);
  bool known() const { return !best_.empty(); }
  /// If known(). @param now_ns  on our clock
  Estimate at(std::int64_t now_ns) const;
  /// Seconds by which ours gains on theirs per second, as far as that can be told; else 0.
  double drift() const;
  std::uint64_t jumps() const { return jumps_; }  ///< after which it began anew

 private:
  struct Interval {
    std::int64_t at_ns = 0;  ///< the middle of the round trip, on our clock
    std::int64_t middle_ns = 0;
    double half = 0;  ///< [s]
  };
  bool contradicts(const Interval& interval) const;

  std::deque<Interval> best_;  ///< of each block, in order of time
  int contradictions_ = 0;
  std::uint64_t jumps_ = 0;
};

}  // namespace palpate::bus
