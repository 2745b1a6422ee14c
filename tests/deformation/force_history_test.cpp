#include "deformation/force_history.h"

#include <catch2/catch.hpp>

using palpate::Vec3;
using palpate::deformation::ForceHistory;

TEST_CASE("force history: growth is the mean of three periods, bounded, and none at first touch") {
  // Oracle: the stated rule, by hand.
  constexpr double kPeriod = 0.01;
  ForceHistory history;
  CHECK(history.growth(kPeriod) == 0);
  history.note(Vec3(0, 0, 1));
  CHECK(history.newest() == Vec3(0, 0, 1));
  CHECK(history.growth(kPeriod) == 0);  // one advance before there was none
  history.note(Vec3(0, 0, 1.1));
  CHECK(history.growth(kPeriod) == Approx(1.1 / 1.1 / 3 / kPeriod));  // from nothing, in three
  history.note(Vec3(0, 0, 1.2));
  history.note(Vec3(0, 0, 1.3));
  CHECK(history.growth(kPeriod) == Approx(0.3 / 1.3 / 3 / kPeriod));
  history.note(Vec3(0, 0, 0.1));
  CHECK(history.growth(kPeriod) == Approx(-ForceHistory::kMostGrowth / kPeriod));
  CHECK(history.growth(0) == 0);
}
