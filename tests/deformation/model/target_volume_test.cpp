#include "deformation/model/target_volume.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

namespace palpate::deformation {
namespace {

scene::Filling filled_by_a_quarter() {
  scene::Filling filling;
  filling.points = {{1, 1}, {3, 1.25}};
  return filling;
}

TEST_CASE("target volume: without a filling it stays the rest volume") {
  // Oracle: definition.
  TargetVolume target{scene::Filling{}};
  for (int i = 1; i < 50; ++i) CHECK(target.follow(0.1 * i, 0.1) == 1);
}

TEST_CASE("target volume: a curve passes its points and is held outside them") {
  // Oracle: definition, and the midpoint symmetry of a minimum-jerk move.
  const auto filling = filled_by_a_quarter();
  CHECK(TargetVolume::asked(filling, 0) == 1);
  CHECK(TargetVolume::asked(filling, 1) == 1);
  CHECK(TargetVolume::asked(filling, 2) == Approx(1.125).epsilon(1e-14));
  CHECK(TargetVolume::asked(filling, 3) == 1.25);
  CHECK(TargetVolume::asked(filling, 100) == 1.25);
}

TEST_CASE("target volume: a curve begins and ends without a jump of its rate") {
  // Oracle: finite differences on both sides of a point.
  const auto filling = filled_by_a_quarter();
  for (const double t : {1.0, 3.0}) {
    const double e = 1e-4;
    const double before = TargetVolume::asked(filling, t) - TargetVolume::asked(filling, t - e);
    const double after = TargetVolume::asked(filling, t + e) - TargetVolume::asked(filling, t);
    CHECK(std::abs(after - before) / e < 1e-6);
  }
}

TEST_CASE("target volume: breathing is a sine of the given amplitude and rate") {
  // Oracle: the formula.
  scene::Filling filling;
  filling.breathing_amplitude = 0.1;
  filling.breathing_rate = 0.3;
  TargetVolume target{filling};
  for (int i = 1; i < 2000; ++i) {
    const double t = 1e-3 * i;
    const double expected = 1 + 0.1 * std::sin(2 * std::numbers::pi * 0.3 * t);
    REQUIRE(target.follow(t, 1e-3) == Approx(expected).epsilon(1e-14));
  }
}

TEST_CASE("target volume: a curve that begins elsewhere is reached at the largest rate") {
  // Oracle: 0.2 at 0.5 per second takes 0.4 s.
  scene::Filling filling;
  filling.points = {{0, 1.2}};
  TargetVolume target{filling};
  double ratio = 1;
  for (int i = 1; i <= 39; ++i) {
    const double next = target.follow(0.01 * i, 0.01);
    CHECK(next - ratio == Approx(0.005).epsilon(1e-9));
    ratio = next;
  }
  CHECK(target.follow(0.4, 0.01) == Approx(1.2).epsilon(1e-12));
  CHECK(target.follow(0.5, 0.01) == 1.2);
  target.reset();
  CHECK(target.follow(0.01, 0.01) == Approx(1.005).epsilon(1e-12));
}

TEST_CASE(
    "target volume: what is asked for at run time replaces the scene's, as slowly, until reset") {
  // Oracle: definition; 0.5 per second is a filling's own rate.
  TargetVolume target{filled_by_a_quarter()};
  target.ask(1.1);
  CHECK(target.follow(0.1, 0.1) == Approx(1.05).epsilon(1e-14));
  CHECK(target.follow(0.2, 0.1) == Approx(1.1).epsilon(1e-14));
  CHECK(target.follow(9, 0.1) == Approx(1.1).epsilon(1e-14));
  target.reset();
  CHECK(target.follow(0.1, 0.1) == 1);
  CHECK(target.follow(9, 1) == 1.25);
}

}  // namespace
}  // namespace palpate::deformation
