#include "modules/geometry/winding_number.h"

#include <catch2/catch.hpp>

#include "modules/geometry/primitives.h"

namespace palpate::geometry {

TEST_CASE("winding number: 1 inside a ball, 0 outside, −1 inside one that is turned inside out") {
  // Oracle: analytic; of a closed surface it is whole.
  TriangleSurface ball = make_ball(1, 2);
  std::vector<float> positions;
  for (const Vec3& x : ball.nodes) {
    for (int axis = 0; axis < 3; ++axis) positions.push_back(static_cast<float>(x[axis]));
  }
  const Vec3 inside(0.3, -0.5, 0.2), outside(0.3, -0.9, 0.9);
  CHECK(winding_number(inside, positions, ball.triangles) == Approx(1).margin(1e-6));
  CHECK(winding_number(outside, positions, ball.triangles) == Approx(0).margin(1e-6));
  CHECK(winding_number(inside, ball.nodes, ball.triangles) == Approx(1).margin(1e-12));
  CHECK(winding_number(outside, ball.nodes, ball.triangles) == Approx(0).margin(1e-12));
  for (Triangle& t : ball.triangles) std::swap(t[0], t[1]);
  CHECK(winding_number(inside, ball.nodes, ball.triangles) == Approx(-1).margin(1e-12));
}

}  // namespace palpate::geometry
