#include "palpate/restart_policy.h"

#include <catch2/catch.hpp>

using palpate::launcher::RestartPolicy;

TEST_CASE("restart: at once, then after pauses that double, five in a row") {
  // Oracle: the stated rule, by hand.
  RestartPolicy policy;
  for (const double pause : {0.0, 0.1, 0.2, 0.4, 0.8}) {
    CHECK(policy.pause_after(10, 11) == Approx(pause));
  }
  CHECK_FALSE(policy.pause_after(10, 11));
  CHECK(policy.pause_after(10, 10 + RestartPolicy::kForgivenAfter) == 0.0);
  CHECK(policy.pause_after(10, 11) == Approx(0.1));
}
