#include "modules/runtime/clock.h"

#include <time.h>

#include <catch2/catch.hpp>

TEST_CASE("clock: is the system's monotonic clock") {
  // Oracle: CLOCK_MONOTONIC read before and after.
  timespec before{}, after{};
  clock_gettime(CLOCK_MONOTONIC, &before);
  const std::int64_t now = palpate::runtime::monotonic_now_ns();
  clock_gettime(CLOCK_MONOTONIC, &after);
  CHECK(before.tv_sec * 1'000'000'000 + before.tv_nsec <= now);
  CHECK(now <= after.tv_sec * 1'000'000'000 + after.tv_nsec);
}

TEST_CASE("clock: a thread's own time does not pass while it sleeps") {
  // Oracle: the monotonic clock, which does; half of the sleep is far above what waking takes.
  using namespace palpate::runtime;
  const std::int64_t before = thread_time_ns(), begin = monotonic_now_ns();
  const timespec pause{0, 20'000'000};
  nanosleep(&pause, nullptr);
  CHECK(monotonic_now_ns() - begin >= 20'000'000);
  CHECK(thread_time_ns() >= before);
  CHECK(thread_time_ns() - before < 10'000'000);
}
