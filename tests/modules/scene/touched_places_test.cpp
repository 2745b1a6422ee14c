#include "modules/scene/touched_places.h"

#include <catch2/catch.hpp>

#include "modules/geometry/primitives.h"

namespace palpate::scene {
namespace {

TEST_CASE("touched places: where a sphere comes down on a ball, how deep, and once each") {
  // Oracle: spheres; facets of a ball of 50 mm with 642 nodes lie 0.4 mm inside it at most.
  const auto ball = geometry::make_ball(0.05, 3);
  constexpr double kFacets = 4e-4;
  const auto at = [](double height) {
    return geometry::RoundedSegment{Vec3(0, 0, height), Vec3(0, 0, height), 0.01};
  };
  const Touch touch = touch_of(ball, at(0.054));
  CHECK((touch.place - Vec3(0, 0, 0.05)).norm() < kFacets);
  CHECK(touch.depth == Approx(0.006).margin(kFacets));
  CHECK(touch.outward.z() > 0.99);
  CHECK(touch_of(ball, at(0.045)).depth == Approx(0.015).margin(kFacets));  // its middle inside
  CHECK(touch_of(ball, at(0.065)).depth == Approx(-0.005).margin(kFacets));

  std::vector<SphereRegion> balls;
  for (const double height : {0.065, 0.058, 0.054, 0.05}) add_touched(ball, at(height), balls);
  REQUIRE(balls.size() == 1);
  CHECK(balls[0].radius == 0.01);
  CHECK((balls[0].center - Vec3(0, 0, 0.05)).norm() < kFacets);
  add_touched(ball, {Vec3(0.055, 0, 0), Vec3(0.055, 0, 0), 0.01}, balls);
  CHECK(balls.size() == 2);
}

}  // namespace
}  // namespace palpate::scene
