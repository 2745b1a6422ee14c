#include "modules/core/stop_signal.h"

#include <catch2/catch.hpp>
#include <csignal>

using palpate::stop_requested;
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
      CHECK_FALSE(stop_requested());
      raise(number);
      CHECK(stop.requested());
      CHECK(stop_requested());
    }
    CHECK_FALSE(stop_requested());
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

TEST_CASE("stop signal: SIGHUP that was ignored when it began stays ignored") {
  // Oracle: the signal's action as the system reports it; nohup begins programs so.
  struct sigaction before {
  }, during{};
  struct sigaction ignored {};
  ignored.sa_handler = SIG_IGN;
  sigaction(SIGHUP, &ignored, &before);
  {
    const StopSignal stop;
    sigaction(SIGHUP, nullptr, &during);
    CHECK(during.sa_handler == SIG_IGN);
    raise(SIGHUP);
    CHECK_FALSE(stop.requested());
    raise(SIGTERM);
    CHECK(stop.requested());
  }
  sigaction(SIGHUP, &before, nullptr);
}

TEST_CASE("stop signal: Ctrl-Z is told of and does not stop the program") {
  // Oracle: that this goes on, and the signal's action as the system reports it.
  struct sigaction before {
  }, after{};
  sigaction(SIGTSTP, nullptr, &before);
  {
    palpate::NoSuspension none;
    CHECK_FALSE(none.take());
    raise(SIGTSTP);
    CHECK(none.take());
    CHECK_FALSE(none.take());
  }
  sigaction(SIGTSTP, nullptr, &after);
  CHECK(before.sa_handler == after.sa_handler);
}
