#include "modules/core/stop_signal.h"

#include <catch2/catch.hpp>
#include <csignal>

using palpate::StopSignal;

TEST_CASE("stop signal: SIGINT, SIGTERM and SIGHUP are requests, and only while one exists") {
  // Oracle: the signal's action as the system reports it.
  for (const int number : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction before {
    }, after{};
    sigaction(number, nullptr, &before);
    {
      const StopSignal stop;
      CHECK_FALSE(stop.requested());
      raise(number);
      CHECK(stop.requested());
    }
    sigaction(number, nullptr, &after);
    CHECK(before.sa_handler == after.sa_handler);
  }
}

TEST_CASE("stop signal: one within another keeps a request that came before, and the signals") {
  // Oracle: definition; without it a signal just before the inner one was lost, and one just after
  // it would end this process.
  const StopSignal outer;
  raise(SIGINT);
  {
    const StopSignal inner;
    CHECK(inner.requested());
  }
  raise(SIGTERM);
  CHECK(outer.requested());
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
