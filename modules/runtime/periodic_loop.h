// The heartbeat of a module: one cycle per period of an absolute time grid.
#pragma once

#include <cstdint>

#include "modules/runtime/time_histogram.h"

namespace palpate::runtime {

/// The period a loop belongs to when it wakes, and how many it slept through.
struct PeriodStart {
  std::int64_t scheduled_ns = 0;  ///< begin of the period this cycle belongs to
  std::uint64_t missed = 0;       ///< periods that passed entirely without a cycle
};

/// The overrun policy: periods that have passed are skipped and counted, never made up for. At most
/// one cycle belongs to a period, so a late loop does not burst; a cycle that begins within its
/// period, however late, is on time. Times on one clock, period_ns > 0.
PeriodStart begin_period(std::int64_t scheduled_ns, std::int64_t now_ns, std::int64_t period_ns);

struct LoopStatistics {
  std::uint64_t cycles = 0;
  std::uint64_t overruns = 0;          ///< periods missed
  std::int64_t worst_lateness_ns = 0;  ///< of a wake-up
  std::int64_t busy_ns = 0;            ///< spent in cycles, in all
  TimeHistogram lateness;

  /// Periods that had their cycle, of all that passed; 1 before the first.
  double on_time_fraction() const;
};

/// while (…) { loop.wait_for_period(); … }. The loop itself never allocates, locks or throws.
class PeriodicLoop {
 public:
  /// Sets the timer slack of the calling thread, which has to be the one that loops, to 1 ns.
  /// @param rate_hz  1e-9 … 1e9
  explicit PeriodicLoop(double rate_hz);

  /// Sleeps until the next period begins; the first begins at the first call. Returns early, with
  /// the same period still to come, when a signal interrupts the sleep: then false.
  bool wait_for_period();

  std::int64_t woke_ns() const { return woke_ns_; }  ///< when this cycle began, monotonic clock
  /// When the period began that this cycle belongs to: a whole number of periods after the first.
  std::int64_t period_began_ns() const { return scheduled_ns_ - period_ns_; }
  std::int64_t period_ns() const { return period_ns_; }
  double rate_hz() const { return 1e9 / static_cast<double>(period_ns_); }
  const LoopStatistics& statistics() const { return statistics_; }

 private:
  static constexpr double kLongestPeriod = 1e9;  ///< [s]
  std::int64_t period_ns_ = 0;
  std::int64_t scheduled_ns_ = 0;  ///< of the next cycle; 0 before the first
  std::int64_t woke_ns_ = 0;
  bool in_cycle_ = false;
  LoopStatistics statistics_;
};

}  // namespace palpate::runtime
