#include "deformation/usual_age.h"

#include <catch2/catch.hpp>

using palpate::deformation::UsualAge;

TEST_CASE("usual age: it is the oldest of late, no less than a floor, and no silence") {
  // Oracle: the stated rule, by hand.
  UsualAge age(0.05, 0.004);
  CHECK(age.limit() == UsualAge::kLeast);
  age.note(0.004, 0.004);
  CHECK(age.limit() == UsualAge::kLeast);
  age.note(0.030, 0.004);
  CHECK(age.limit() == 0.030);
  age.note(0.4, 0.4);  // it had been silent
  CHECK(age.limit() < 0.030);
  CHECK(age.limit() > 0.028);
  age.note(0.004, UsualAge::kForgotten);
  CHECK(age.limit() == UsualAge::kLeast);
  CHECK(UsualAge(0.05, 1 / 61.0).limit() == 1 / 61.0);  // of a source that is slow
}
