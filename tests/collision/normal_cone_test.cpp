#include "collision/normal_cone.h"

#include <catch2/catch.hpp>

#include "tests/collision/random_shapes.h"

namespace palpate::collision {

TEST_CASE("normal cone: two may oppose if a direction of one is against one of the other") {
  // Oracle: brute force over directions of both, and the angle between the axes.
  RandomShapes random(5);
  int may = 0, may_not = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const Vec3 a = random.direction(), b = random.direction();
    const NormalCone one(a, random.number(0, 2)), other(b, random.number(0, 2));
    const bool found = one.may_oppose(other);
    (found ? may : may_not)++;
    CHECK(found == other.may_oppose(one));
    const double apart = std::acos(-a.dot(b));
    CHECK(found == (apart <= one.angle() + other.angle()));
    if (found) continue;
    for (int k = 0; k < 20; ++k) {
      const Vec3 d = random.direction();
      const bool in_one = std::acos(d.dot(a)) <= one.angle();
      CHECK_FALSE((in_one && std::acos(-d.dot(b)) <= other.angle()));
    }
  }
  CHECK(may > 50);
  CHECK(may_not > 50);
  const NormalCone none(Vec3::UnitX(), -0.1), all;
  CHECK_FALSE(none.may_oppose(all));
  CHECK_FALSE(all.may_oppose(none));
  CHECK(all.may_oppose(NormalCone(Vec3::UnitX(), 0)));
}

TEST_CASE(
    "normal cone: an edge faces what lies between its faces' normals, one in a dent nothing") {
  // Oracle: by hand, a right angle seen from either side.
  const Vec3 up = Vec3::UnitZ(), side = Vec3::UnitX();
  const NormalCone ridge = cone_of_edge(up, side, -up);  // the other face goes down
  CHECK(ridge.axis().dot((up + side).normalized()) == Approx(1));
  CHECK(ridge.angle() == Approx(M_PI / 4 + kConeSlack).margin(0.002));
  CHECK(cone_of_edge(up, side, up).is_empty());
  const NormalCone flat = cone_of_edge(up, up, side);
  CHECK(flat.angle() == Approx(kConeSlack).margin(0.002));
  CHECK(cone_of_edge(up, -up, side).angle() == Approx(M_PI));  // a leaf's edge: anything
}

}  // namespace palpate::collision
