#include "modules/runtime/periodic_loop.h"

#include <sys/wait.h>
#include <unistd.h>

#include <catch2/catch.hpp>
#include <cmath>
#include <csignal>
#include <random>

#include "modules/core/stop_signal.h"
#include "modules/runtime/clock.h"
#include "tests/modules/runtime/own_bus.h"

using palpate::runtime::begin_period;
using palpate::runtime::monotonic_now_ns;
using palpate::runtime::PeriodicLoop;

TEST_CASE("begin_period: a wake-up within its period is on time, however late") {
  // Oracle: the policy, by hand.
  for (const std::int64_t late : {0, 1, 500, 999}) {
    CHECK(begin_period(7000, 7000 + late, 1000).scheduled_ns == 7000);
    CHECK(begin_period(7000, 7000 + late, 1000).missed == 0);
  }
  CHECK(begin_period(7000, 6990, 1000).missed == 0);  // a clock that wakes a little early
}

TEST_CASE("begin_period: periods that have passed are skipped and counted") {
  // Oracle: the policy, by hand.
  CHECK(begin_period(7000, 8000, 1000).missed == 1);
  CHECK(begin_period(7000, 8000, 1000).scheduled_ns == 8000);
  CHECK(begin_period(7000, 12'345, 1000).missed == 5);
  CHECK(begin_period(7000, 12'345, 1000).scheduled_ns == 12'000);
}

TEST_CASE("begin_period: whatever the delays, one cycle per period and none unaccounted for") {
  // Oracle: invariant. Cycles and misses add up to the periods passed; starts stay on the grid.
  std::mt19937 random(2);
  std::exponential_distribution<double> work(1.0 / 700);
  constexpr std::int64_t kPeriod = 1000;
  std::int64_t now = 0, scheduled = 0, last_start = -kPeriod;
  std::int64_t cycles = 0, missed = 0;
  for (int i = 0; i < 100'000; ++i) {
    now = std::max(now, scheduled);
    const auto start = begin_period(scheduled, now, kPeriod);
    REQUIRE(start.scheduled_ns % kPeriod == 0);
    REQUIRE(start.scheduled_ns > last_start);  // never twice in one period: no burst
    REQUIRE(now - start.scheduled_ns < kPeriod);
    last_start = start.scheduled_ns;
    ++cycles;
    missed += static_cast<std::int64_t>(start.missed);
    scheduled = start.scheduled_ns + kPeriod;
    now += static_cast<std::int64_t>(work(random));
  }
  CHECK(cycles + missed == last_start / kPeriod + 1);
  CHECK(missed > 0);
}

TEST_CASE("periodic loop: keeps to the grid of its first cycle") {
  // Oracle: the clock. Never early; as many periods as time allows, missed ones counted.
  PeriodicLoop loop(500);
  loop.wait_for_period();
  const std::int64_t first = loop.period_began_ns();  // it may wake late itself
  for (int i = 0; i < 50; ++i) loop.wait_for_period();
  const auto& statistics = loop.statistics();
  CHECK(statistics.cycles == 51);
  const auto periods = static_cast<std::int64_t>(50 + statistics.overruns);
  CHECK(loop.woke_ns() - first >= periods * loop.period_ns());
  CHECK(statistics.lateness.count() == 51);
  CHECK(statistics.worst_lateness_ns >= 0);
}

TEST_CASE("periodic loop: a cycle longer than its period costs periods and is seen") {
  // Oracle: a cycle that works for 5.5 periods.
  PeriodicLoop loop(1000);
  loop.wait_for_period();
  while (monotonic_now_ns() < loop.woke_ns() + 5'500'000) {
  }
  loop.wait_for_period();
  CHECK(loop.statistics().overruns >= 4);
  CHECK(loop.statistics().worst_lateness_ns >= 4'000'000);
  CHECK(loop.statistics().busy_ns >= 5'500'000);
  const double periods = 2.0 + static_cast<double>(loop.statistics().overruns);
  CHECK(loop.statistics().on_time_fraction() == Approx(2 / periods));
}

TEST_CASE("periodic loop: a signal ends the wait") {
  // Oracle: a loop of 0.01 Hz would sleep for 100 s.
  const palpate::StopSignal stop;
  PeriodicLoop loop(0.01);
  loop.wait_for_period();
  sigevent event{};
  event.sigev_notify = SIGEV_SIGNAL;
  event.sigev_signo = SIGTERM;
  timer_t timer;
  REQUIRE(timer_create(CLOCK_MONOTONIC, &event, &timer) == 0);
  const itimerspec every_50_ms = {{0, 50'000'000}, {0, 50'000'000}};
  timer_settime(timer, 0, &every_50_ms, nullptr);
  CHECK_FALSE(loop.wait_for_period());
  timer_delete(timer);
  CHECK(palpate::testing::wait_until([&] { return stop.requested(); }));
  CHECK(loop.statistics().cycles == 1);
}

TEST_CASE("periodic loop: a rate without a period stops the program") {
  // Oracle: the documented range; the signal that ends a child process.
  for (const double rate : {0.0, -1.0, std::nan(""), 1e-12, 1e10}) {
    CAPTURE(rate);
    const pid_t child = fork();
    if (child == 0) {
      std::signal(SIGABRT, SIG_DFL);
      close(STDERR_FILENO);
      const PeriodicLoop loop(rate);
      _exit(0);
    }
    int status = 0;
    REQUIRE(waitpid(child, &status, 0) == child);
    CHECK(WIFSIGNALED(status));
    CHECK(WTERMSIG(status) == SIGABRT);
  }
}
