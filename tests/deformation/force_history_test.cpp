#include "deformation/force_history.h"

#include <catch2/catch.hpp>

using palpate::Vec3;
using palpate::deformation::ForceHistory;

TEST_CASE("force history: growth is the mean of three periods, bounded, and none at first touch") {
  // Oracle: the stated rule, by hand.
  constexpr double kPeriod = 0.01, kInwards = 1e-3;
  ForceHistory history;
  CHECK(history.growth(kPeriod, kInwards) == 0);
  history.note(Vec3(0, 0, 1));
  CHECK(history.newest() == Vec3(0, 0, 1));
  CHECK(history.growth(kPeriod, kInwards) == 0);  // one advance before there was none
  history.note(Vec3(0, 0, 1.1));
  CHECK(history.growth(kPeriod, kInwards) ==
        Approx(1.1 / 1.1 / 3 / kPeriod));  // from nothing, in three
  history.note(Vec3(0, 0, 1.2));
  history.note(Vec3(0, 0, 1.3));
  CHECK(history.growth(kPeriod, kInwards) == Approx(0.3 / 1.3 / 3 / kPeriod));
  history.note(Vec3(0, 0, 0.1));
  CHECK(history.growth(kPeriod, -kInwards) == Approx(-ForceHistory::kMostGrowth / kPeriod));
  CHECK(history.growth(0, kInwards) == 0);
}

TEST_CASE("force history: what contradicts the tissue's motion is its swing and does not go on") {
  // Oracle: elastic tissue pushes back more the further it is pressed in.
  constexpr double kPeriod = 0.01;
  ForceHistory falling, rising;
  for (const double force : {1.3, 1.2, 1.1, 1.0}) {
    falling.note(Vec3(0, force, 0));
    rising.note(Vec3(0, 2 - force, 0));
  }
  CHECK(falling.growth(kPeriod, 1e-3) == 0);
  CHECK(falling.growth(kPeriod, -1e-3) < 0);
  CHECK(falling.growth(kPeriod, 0) < 0);  // at rest nothing contradicts
  CHECK(rising.growth(kPeriod, 1e-3) > 0);
  CHECK(rising.growth(kPeriod, -1e-3) == 0);
}
