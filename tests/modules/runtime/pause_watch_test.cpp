#include "modules/runtime/pause_watch.h"

#include <catch2/catch.hpp>

#include "tests/times.h"

using namespace palpate;
using runtime::PauseWatch;

TEST_CASE("pause watch: a cycle long after the one before it is the first after a stop") {
  // Oracle: definition; slow loops have longer periods, and the first cycle none before it.
  for (const double period : {0.004, 0.1}) {
    PauseWatch watch(period);
    const auto limit_ns = ns_from_seconds(std::max(PauseWatch::kStopped, 3 * period));
    std::int64_t now_ns = 1000 * kMs;
    CHECK_FALSE(watch.was_stopped(now_ns, 0));
    CHECK_FALSE(watch.was_stopped(now_ns += limit_ns, 0));
    CHECK(watch.was_stopped(now_ns += limit_ns + 1, 0));
    CHECK_FALSE(watch.was_stopped(now_ns += ns_from_seconds(period), 0));
  }
}

TEST_CASE("pause watch: a cycle that computes for long is no stop, what it waited within is") {
  // Oracle: definition.
  PauseWatch watch(0.004);
  CHECK_FALSE(watch.was_stopped(1000 * kMs, 7 * kMs));
  CHECK_FALSE(watch.was_stopped(2000 * kMs, 990 * kMs));
  CHECK_FALSE(watch.was_stopped(3000 * kMs, 1800 * kMs));
  CHECK(watch.was_stopped(4000 * kMs, 2500 * kMs));
}
