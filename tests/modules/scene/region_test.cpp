#include "modules/scene/region.h"

#include <catch2/catch.hpp>

namespace palpate::scene {

TEST_CASE("region: distance is 0 within and on the border, and grows outside") {
  // Oracle: analytic.
  const Region sphere = SphereRegion{Vec3(1, 0, 0), 2},
               box = BoxRegion{Vec3(0, 0, 0), Vec3(1, 2, 3)};
  for (const Vec3& x : {Vec3(1, 0, 0), Vec3(1, 2, 0), Vec3(-1, 0, 0)}) {
    CHECK(distance(sphere, x) == 0);
    CHECK(contains(sphere, x));
  }
  CHECK(distance(sphere, Vec3(1, 3, 4)) == 3);
  CHECK_FALSE(contains(sphere, Vec3(1, 2.0000001, 0)));
  for (const Vec3& x : {Vec3(0.5, 1, 2), Vec3(0, 0, 0), Vec3(1, 2, 3)}) {
    CHECK(distance(box, x) == 0);
    CHECK(contains(box, x));
  }
  CHECK(distance(box, Vec3(4, 6, 3)) == 5);
  CHECK(distance(box, Vec3(0.5, 1, -2)) == 2);
  CHECK_FALSE(contains(box, Vec3(1.0000001, 1, 1)));
}

}  // namespace palpate::scene
