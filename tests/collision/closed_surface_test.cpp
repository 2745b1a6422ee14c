#include "collision/closed_surface.h"

#include <catch2/catch.hpp>

#include "modules/geometry/closest_points.h"
#include "modules/geometry/primitives.h"
#include "modules/geometry/winding_number.h"
#include "tests/collision/random_shapes.h"

namespace palpate::collision {
namespace {

OrganSurface organ_of(const geometry::TriangleSurface& surface) {
  OrganSurface organ(surface.triangles);
  organ.update(surface.nodes);
  return organ;
}

/// A ball with dents and folds: its nodes moved by up to `by` of their radius.
geometry::TriangleSurface crumpled_ball(RandomShapes& random, double by) {
  auto ball = geometry::make_ball(1, 2);
  for (Vec3& x : ball.nodes) x += by * random.number(0, 1) * random.direction();
  return ball;
}

}  // namespace

TEST_CASE("closed surface: encloses what it winds around, folded through itself or not") {
  // Oracle: winding number by solid angles.
  RandomShapes random(5);
  ClosedSurface closed;
  int inside = 0;
  for (const double by : {0.0, 0.2, 0.6}) {
    for (int shape = 0; shape < 5; ++shape) {
      const auto surface = crumpled_ball(random, by);
      const OrganSurface organ = organ_of(surface);
      for (int trial = 0; trial < 300; ++trial) {
        const Vec3 p = random.number(0, 1.5) * random.direction();
        const double winding = geometry::winding_number(p, surface.nodes, surface.triangles);
        REQUIRE(closed.encloses(organ, p) == (winding > 0.5));
        inside += winding > 0.5;
      }
    }
  }
  CHECK(inside > 1000);
}

TEST_CASE("closed surface: encloses a part of a segment, wherever that is") {
  // Oracle: winding number by solid angles, at places all along.
  RandomShapes random(7);
  ClosedSurface closed;
  int between = 0, outside = 0;
  for (const double by : {0.0, 0.2, 0.6}) {
    for (int shape = 0; shape < 4; ++shape) {
      const auto surface = crumpled_ball(random, by);
      const OrganSurface organ = organ_of(surface);
      const auto is_inside = [&](const Vec3& p) {
        return geometry::winding_number(p, surface.nodes, surface.triangles) > 0.5;
      };
      for (int trial = 0; trial < 120; ++trial) {
        const Vec3 a = random.number(0.8, 1.5) * random.direction();
        const Vec3 b = a + random.number(0, 1.5) * random.direction();
        const auto at = closed.encloses_at(organ, a, b);
        if (at) {
          CHECK(is_inside((1 - *at) * a + *at * b));
          between += *at > 0 && *at < 1;
          continue;
        }
        for (int i = 0; i <= 100; ++i) REQUIRE_FALSE(is_inside(a + i / 100.0 * (b - a)));
        ++outside;
      }
    }
  }
  CHECK(between > 50);
  CHECK(outside > 50);
  const OrganSurface box = organ_of(geometry::make_box({2, 2, 2}, 4));
  const auto middle = closed.encloses_at(box, {0.5, 0.5, -3}, {0.5, 0.5, 2});  // through nodes
  REQUIRE(middle);
  CHECK(*middle == Approx(0.6));
  CHECK(closed.encloses_at(box, {0, 0, 0}, {0, 0, 0}) == 0);
  CHECK(closed.encloses_at(box, {0, 0, 2}, {0, 0, 0}) == 1);
}

TEST_CASE("closed surface: a ray through nodes, edges or within faces is counted once") {
  // Oracle: analytic; a box whose nodes lie on a grid, points on the same grid.
  const auto box = geometry::make_box({2, 2, 2}, 4);
  const OrganSurface organ = organ_of(box);
  ClosedSurface closed;
  for (int i = -3; i <= 3; ++i) {
    for (int j = -3; j <= 3; ++j) {
      for (int k = -3; k <= 3; ++k) {
        const Vec3 p(0.5 * i, 0.5 * j, 0.5 * k);
        if (p.cwiseAbs().maxCoeff() == 1) continue;  // on the surface
        CHECK(closed.encloses(organ, p) == (p.cwiseAbs().maxCoeff() < 1));
      }
    }
  }
}

TEST_CASE("closed surface: follows nodes that moved without its boxes") {
  // Oracle: analytic; a ball that wandered off by less than an edge.
  auto ball = geometry::make_ball(0.05, 3);
  OrganSurface organ = organ_of(ball);
  ClosedSurface closed;
  CHECK(closed.encloses(organ, {0.0485, 0, 0}));
  for (Vec3& x : ball.nodes) x[0] -= 0.003;
  organ.update(ball.nodes);
  CHECK_FALSE(closed.encloses(organ, {0.0485, 0, 0}));
  CHECK(closed.encloses(organ, {-0.0515, 0, 0}));
}

TEST_CASE("closed surface: the nearest triangle is the nearest of all") {
  // Oracle: brute force over all triangles.
  RandomShapes random(6);
  ClosedSurface closed;
  const auto surface = crumpled_ball(random, 0.2);
  const OrganSurface organ = organ_of(surface);
  for (int trial = 0; trial < 200; ++trial) {
    const Vec3 p = random.number(0, 4) * random.direction();
    double nearest = 1e300;
    for (const auto& t : surface.triangles) {
      const geometry::TriangleCorners corners{surface.nodes[t[0]], surface.nodes[t[1]],
                                              surface.nodes[t[2]]};
      nearest = std::min(nearest, (geometry::closest_on_triangle(p, corners).point - p).norm());
    }
    double distance = 0;
    const auto& t = surface.triangles[closed.nearest_triangle(organ, p, distance)];
    const geometry::TriangleCorners corners{surface.nodes[t[0]], surface.nodes[t[1]],
                                            surface.nodes[t[2]]};
    CHECK(distance == nearest);
    CHECK((geometry::closest_on_triangle(p, corners).point - p).norm() == nearest);
  }
}

}  // namespace palpate::collision
