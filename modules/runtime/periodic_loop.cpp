#include "modules/runtime/periodic_loop.h"

#include <sys/prctl.h>
#include <time.h>

#include <algorithm>

#include "modules/core/error.h"
#include "modules/core/units.h"
#include "modules/runtime/clock.h"

namespace palpate::runtime {
namespace {

/// False if a signal came first.
bool sleep_until(std::int64_t wake_ns) {
  timespec wake{};
  wake.tv_sec = wake_ns / kNanosecondsPerSecond;
  wake.tv_nsec = wake_ns % kNanosecondsPerSecond;
  return clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &wake, nullptr) == 0;
}

}  // namespace

PeriodStart begin_period(std::int64_t scheduled_ns, std::int64_t now_ns, std::int64_t period_ns) {
  const std::int64_t missed = std::max<std::int64_t>(0, (now_ns - scheduled_ns) / period_ns);
  return {scheduled_ns + missed * period_ns, static_cast<std::uint64_t>(missed)};
}

double LoopStatistics::on_time_fraction() const {
  if (cycles == 0) return 1;
  return static_cast<double>(cycles) / static_cast<double>(cycles + overruns);
}

PeriodicLoop::PeriodicLoop(double rate_hz) {
  const double period = 1.0 / rate_hz;
  PALPATE_DEMAND(period >= 1e-9 && period <= kLongestPeriod);  // before it becomes a number of ns
  period_ns_ = ns_from_seconds(period);
  prctl(PR_SET_TIMERSLACK, 1);
}

bool PeriodicLoop::wait_for_period() {
  if (in_cycle_) statistics_.busy_ns += monotonic_now_ns() - woke_ns_;
  in_cycle_ = false;
  if (scheduled_ns_ == 0) scheduled_ns_ = monotonic_now_ns();
  if (!sleep_until(scheduled_ns_)) return false;

  woke_ns_ = monotonic_now_ns();
  const std::int64_t lateness_ns = woke_ns_ - scheduled_ns_;
  const PeriodStart period = begin_period(scheduled_ns_, woke_ns_, period_ns_);
  scheduled_ns_ = period.scheduled_ns + period_ns_;
  in_cycle_ = true;
  ++statistics_.cycles;
  statistics_.overruns += period.missed;
  statistics_.worst_lateness_ns = std::max(statistics_.worst_lateness_ns, lateness_ns);
  statistics_.lateness.add(lateness_ns);
  return true;
}

}  // namespace palpate::runtime
