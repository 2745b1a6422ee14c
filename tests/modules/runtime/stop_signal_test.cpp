#include "modules/runtime/stop_signal.h"

#include <catch2/catch.hpp>

using palpate::runtime::StopSignal;

TEST_CASE("stop signal: SIGINT and SIGTERM are requests, and only while one exists") {
  // Oracle: the signal's action as the system reports it.
  struct sigaction before {
  }, after{};
  sigaction(SIGTERM, nullptr, &before);
  for (const int number : {SIGINT, SIGTERM}) {
    const StopSignal stop;
    CHECK_FALSE(stop.requested());
    raise(number);
    CHECK(stop.requested());
  }
  sigaction(SIGTERM, nullptr, &after);
  CHECK(before.sa_handler == after.sa_handler);
}

TEST_CASE("stop signal: a new one begins without a request") {
  // Oracle: definition.
  {
    const StopSignal stop;
    raise(SIGINT);
    REQUIRE(stop.requested());
  }
  const StopSignal stop;
  CHECK_FALSE(stop.requested());
}
