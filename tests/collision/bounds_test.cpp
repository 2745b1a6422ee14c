#include "collision/bounds.h"

#include <catch2/catch.hpp>

namespace palpate::collision {

TEST_CASE("bounds: boxes that share only a face overlap") {
  // Oracle: analytic.
  const Bounds one{Vec3(0, 0, 0), Vec3(1, 1, 1)}, beside{Vec3(1, 0, 0), Vec3(2, 1, 1)};
  const Bounds apart{Vec3(1.001, 0, 0), Vec3(2, 1, 1)};
  CHECK(one.overlaps(beside));
  CHECK_FALSE(one.overlaps(apart));
  CHECK_FALSE(Bounds().overlaps(one));
}

TEST_CASE("bounds: the distance of two boxes, in doubles and of a block") {
  // Oracle: analytic.
  const Bounds one{Vec3(0, 0, 0), Vec3(1, 1, 1)}, beyond_edge{Vec3(4, 5, 0.5), Vec3(5, 6, 0.6)};
  CHECK(one.squared_distance(beyond_edge) == 9 + 16);
  CHECK(beyond_edge.squared_distance(one) == 9 + 16);
  CHECK(one.squared_distance(one) == 0);
  geometry::BlockBox block;
  block.add(Vec3(4, 5, 0.5));
  block.add(Vec3(5, 6, 0.75));
  CHECK(one.squared_distance(block) == 9 + 16);
  CHECK_FALSE(one.overlaps(block));
  block.add(Vec3(1, 1, 1));
  CHECK(one.overlaps(block));
  Bounds both = one;
  both.add(block);
  CHECK(both.upper == Vec3(5, 6, 1));
  CHECK(both.lower == Vec3(0, 0, 0));
}

}  // namespace palpate::collision
