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
