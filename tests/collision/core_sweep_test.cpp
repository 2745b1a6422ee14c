#include "collision/core_sweep.h"

#include <catch2/catch.hpp>

#include "tests/collision/random_shapes.h"

namespace palpate::collision {
namespace {

SweptTriangle moving(const geometry::TriangleCorners& start, const geometry::TriangleCorners& end) {
  SweptTriangle triangle;
  triangle.start = start;
  triangle.end = end;
  triangle.normal_end = geometry::unit_normal(end);
  for (int k = 0; k < 3; ++k)
    triangle.travel = std::max(triangle.travel, (end[k] - start[k]).norm());
  return triangle;
}

SweptTriangle random_sweep(RandomShapes& random, double deform) {
  const geometry::TriangleCorners start = random.triangle(1);
  geometry::TriangleCorners end;
  const Vec3 way = random.point(1.5);
  for (int k = 0; k < 3; ++k) end[k] = start[k] + way + random.point(deform);
  return moving(start, end);
}

Core random_core(RandomShapes& random, int trial) {
  const Vec3 a = random.point(0.5);
  return {0, a, trial % 2 == 0 ? a : random.point(0.5), random.number(0.05, 0.2)};
}

}  // namespace

TEST_CASE("time of touch: never after the first touch, and close before it") {
  // Oracle: brute force, dense sampling of the exact distance over time.
  RandomShapes random(71);
  int touches = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const SweptTriangle triangle = random_sweep(random, 0.3);
    const Core core = random_core(random, trial);
    const double time = time_of_touch(core, triangle);
    double first = 1;
    for (int k = 2000; k >= 0; --k) {
      const double t = k / 2000.0;
      if (closest(core, triangle.at(t)).distance <= core.radius) first = t;
    }
    CHECK(time <= first);
    if (time >= 1) continue;
    ++touches;
    const double gap = closest(core, triangle.at(time)).distance - core.radius;
    CHECK(gap <= 1e-5 * core.radius);
  }
  CHECK(touches > 40);
}

TEST_CASE("time of touch: a sphere falling on a floor") {
  // Oracle: analytic.
  const geometry::TriangleCorners start{Vec3(-9, -9, -3), Vec3(9, -9, -3), Vec3(0, 9, -3)};
  geometry::TriangleCorners end = start;
  for (Vec3& x : end) x[2] = 1;
  const Core sphere{0, Vec3::Zero(), Vec3::Zero(), 0.5};
  CHECK(time_of_touch(sphere, moving(start, end)) == Approx(2.5 / 4).margin(1e-6));
  CHECK(time_of_touch(sphere, moving(start, start)) == 1);
  CHECK(time_of_touch(sphere, moving(end, end)) == 1);
  const geometry::TriangleCorners overlapping{Vec3(-9, -9, 0), Vec3(9, -9, 0), Vec3(0, 9, 0)};
  CHECK(time_of_touch(sphere, moving(overlapping, start)) == 0);
}

TEST_CASE("closest approach: no sampled time is closer, for a triangle that keeps its shape") {
  // Oracle: brute force, dense sampling.
  RandomShapes random(72);
  for (int trial = 0; trial < 200; ++trial) {
    const SweptTriangle triangle = random_sweep(random, 0);
    const Core core = random_core(random, trial);
    const ClosestApproach nearest = closest_approach(core, triangle, 0.2);
    CHECK(nearest.time >= 0.2);
    CHECK(nearest.time <= 1);
    for (int k = 0; k <= 500; ++k) {
      const double t = 0.2 + 0.8 * k / 500.0;
      CHECK(nearest.pair.distance <= closest(core, triangle.at(t)).distance + 1e-7);
    }
  }
}

TEST_CASE("first crossing: no crossing of a sampled core is missed") {
  // Oracle: brute force; the core meets the triangle at a sampled time.
  RandomShapes random(73);
  int crossings = 0;
  for (int trial = 0; trial < 400; ++trial) {
    const SweptTriangle triangle = random_sweep(random, 0.3);
    Core core = random_core(random, trial);
    core.radius = 0;
    const auto crossing = first_crossing(core, triangle, 0);
    double first = 2;
    for (int k = 500; k >= 0; --k) {
      if (closest(core, triangle.at(k / 500.0)).distance == 0) first = k / 500.0;
    }
    if (first <= 1) {
      REQUIRE(crossing);
      // A triangle that is pierced from the start is met by continuous features only later.
      if (first > 0) CHECK(crossing->time <= first);
    }
    if (!crossing) continue;
    ++crossings;
    CHECK(crossing->weights.sum() == Approx(1));
    CHECK(crossing->weights.minCoeff() >= -1e-12);
    Vec3 met = Vec3::Zero();
    const geometry::TriangleCorners at = triangle.at(crossing->time);
    for (int k = 0; k < 3; ++k) met += crossing->weights[k] * at[k];
    CHECK((met - crossing->on_core).norm() < 1e-6);
  }
  CHECK(crossings > 40);
}

}  // namespace palpate::collision
