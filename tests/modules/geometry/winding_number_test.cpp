#include "modules/geometry/winding_number.h"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>
#include <random>

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

TEST_CASE("winding number: any triangles, closed or not, by the sum of their solid angles") {
  // Oracle: an arc tangent per triangle, of Van Oosterom and Strackee's tan(Ω/2).
  std::mt19937 random(3);
  std::uniform_real_distribution<double> anywhere(-1, 1);
  for (const std::size_t count : {1, 2, 50, 1000}) {
    std::vector<Vec3> nodes(3 * count);
    std::vector<Triangle> triangles(count);
    for (Vec3& x : nodes) x = {anywhere(random), anywhere(random), anywhere(random)};
    for (std::uint32_t t = 0; t < count; ++t) triangles[t] = {3 * t, 3 * t + 1, 3 * t + 2};
    double sum = 0;
    for (const Triangle& t : triangles) {
      const Vec3 &a = nodes[t[0]], &b = nodes[t[1]], &c = nodes[t[2]];
      const double l = a.norm(), m = b.norm(), n = c.norm();
      sum +=
          2 * std::atan2(a.dot(b.cross(c)), l * m * n + a.dot(b) * n + a.dot(c) * m + b.dot(c) * l);
    }
    CHECK(winding_number(Vec3::Zero(), nodes, triangles) ==
          Approx(sum / (4 * std::numbers::pi)).margin(1e-12));
  }
}

}  // namespace palpate::geometry
