#include "deformation/simulated_time.h"

#include <catch2/catch.hpp>

using palpate::deformation::SimulatedTime;

TEST_CASE("simulated time: begins with the first advance, and anew with a session begun anew") {
  // Oracle: by hand; the world is at 3 s when it joins at 10 s, and advances half as fast.
  SimulatedTime time;
  time.pass(10, 3);
  CHECK(time.on_session_clock(3) == 10);
  time.pass(12, 4);
  CHECK(time.on_session_clock(4) == 11);
  CHECK(time.factor(12, 4, 0) == Approx(0.5));
  time.pass(0.1, 4);  // a clock that goes back is another session's
  CHECK(time.on_session_clock(4) == Approx(0.1));
  time.pass(0.2, 4.1);
  CHECK(time.factor(0.2, 4.1, 0) == Approx(1));
}
