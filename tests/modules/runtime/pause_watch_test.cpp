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
    CHECK_FALSE(watch.was_stopped(now_ns));
    CHECK_FALSE(watch.was_stopped(now_ns += limit_ns));
    CHECK(watch.was_stopped(now_ns += limit_ns + 1));
    CHECK_FALSE(watch.was_stopped(now_ns += ns_from_seconds(period)));
  }
}
