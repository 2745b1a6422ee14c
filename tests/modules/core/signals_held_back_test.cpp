#include "modules/core/signals_held_back.h"

#include <catch2/catch.hpp>

#include "modules/core/stop_signal.h"

using namespace palpate;

TEST_CASE("signals held back: they come when it ends, and not before") {
  // Oracle: definition; the flag of StopSignal, which they set.
  const StopSignal stop;
  {
    const SignalsHeldBack outer;
    {
      const SignalsHeldBack inner;
      raise(SIGTERM);
    }
    CHECK_FALSE(stop.requested());
  }
  CHECK(stop.requested());
}
