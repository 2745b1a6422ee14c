#include "modules/trajectories/motion_facts.h"

#include <catch2/catch.hpp>

using namespace palpate;
using namespace palpate::trajectories;

TEST_CASE("motion facts: length, extent and fastest motion") {
  // Oracle: by hand.
  const auto at = [](double time, double x, double z) {
    return TimedPose{time, {Vec3(x, 0, z), Quat::Identity()}};
  };
  const auto facts = facts_of({at(1, 0, 0), at(1.5, 0.1, 0), at(3.5, 0.1, -0.3)});
  CHECK(facts.poses == 3);
  CHECK(facts.duration == 2.5);
  CHECK(facts.fastest == Approx(0.2));
  CHECK(facts.extent.isApprox(Vec3(0.1, 0, 0.3)));
}
