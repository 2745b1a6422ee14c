#include "collision/probe_solid.h"

#include <catch2/catch.hpp>

#include "tests/collision/random_shapes.h"

namespace palpate::collision {
namespace {

constexpr double kFar = 1e3;

double box_distance(const Vec3& x, const Vec3& half) {
  const Vec3 q = x.cwiseAbs() - half;
  return q.cwiseMax(0).norm() + std::min(q.maxCoeff(), 0.0);
}

}  // namespace

TEST_CASE("box solid: signed distance, nearest point and normal agree") {
  // Oracle: analytic, the closed form of a box's signed distance; finite differences for the
  // normal.
  RandomShapes random(51);
  const Vec3 half(0.5, 0.3, 0.2);
  const auto box = make_box_solid(2 * half);
  for (int trial = 0; trial < 500; ++trial) {
    const Vec3 x = random.point(0.8);
    const auto near = box->nearest(x, kFar);
    REQUIRE(near);
    CHECK(near->distance == Approx(box_distance(x, half)).margin(1e-14));
    CHECK(std::abs(box_distance(near->point, half)) < 1e-14);
    CHECK(near->outward.norm() == Approx(1));
    CHECK((near->point + near->distance * near->outward - x).norm() < 1e-14);
    CHECK(near->outward.dot(near->outward) == Approx(1));
    const double ahead = box_distance(x + 1e-7 * near->outward, half);
    CHECK((ahead - near->distance) / 1e-7 == Approx(1).margin(1e-6));
  }
  CHECK_FALSE(box->nearest(Vec3(2, 0, 0), 1));
  CHECK(box->nearest(Vec3(0.5, 0.1, 0.1), 1)->outward == Vec3(1, 0, 0));
}

TEST_CASE("box solid: entry is the first point inside, through the face named") {
  // Oracle: brute force; the closed-form distance along the way, sampled.
  RandomShapes random(52);
  const Vec3 half(0.5, 0.3, 0.2);
  const auto box = make_box_solid(2 * half);
  int entries = 0;
  for (int trial = 0; trial < 500; ++trial) {
    const Vec3 start = random.point(1), end = random.point(1);
    const auto entry = box->entry(start, end, 0);
    if (box_distance(start, half) < 0) {
      CHECK_FALSE(entry);
      continue;
    }
    double deepest = 1;
    for (int k = 0; k <= 200; ++k) {
      const double t = k / 200.0, depth = box_distance(start + t * (end - start), half);
      deepest = std::min(deepest, depth);
      if (entry && t < entry->time - 1e-9) CHECK(depth > 0);
    }
    if (deepest < 0) REQUIRE(entry);
    if (deepest > 0.02) CHECK_FALSE(entry);
    if (!entry) continue;
    ++entries;
    CHECK(std::abs(box_distance(entry->point, half)) < 1e-12);
    CHECK(entry->outward.dot(end - start) < 0);
    CHECK((entry->point.cwiseProduct(entry->outward.cwiseAbs()) - entry->outward.cwiseProduct(half))
              .norm() < 1e-12);
  }
  CHECK(entries > 50);
  // A way beside the box enters it only if it is given that much separation.
  CHECK_FALSE(box->entry({0.51, 0, 1}, {0.51, 0, -1}, 0));
  CHECK(box->entry({0.51, 0, 1}, {0.51, 0, -1}, 0.02));
  CHECK(box->entry({0.1, 0.1, 0.205}, {0.1, 0.1, -1}, 0.02)->outward == Vec3(0, 0, 1));
}

TEST_CASE("box solid: its shadow") {
  // Oracle: analytic.
  const auto box = make_box_solid({1, 1, 1});
  CHECK(box->shadows({0.2, 0.2, -3}, Vec3::UnitZ()));
  CHECK(box->shadows({0, 0, 0}, Vec3::UnitZ()));
  CHECK_FALSE(box->shadows({0.2, 0.2, 3}, Vec3::UnitZ()));
  CHECK_FALSE(box->shadows({0.6, 0.2, -3}, Vec3::UnitZ()));
}

TEST_CASE("half-space: distance, entry and shadow") {
  // Oracle: analytic.
  const auto plane = make_half_space();
  const auto above = plane->nearest({1, 2, 0.5}, 1), below = plane->nearest({1, 2, -7}, 1);
  REQUIRE(above);
  CHECK(above->distance == 0.5);
  CHECK(above->point == Vec3(1, 2, 0));
  CHECK(above->outward == Vec3::UnitZ());
  REQUIRE(below);
  CHECK(below->distance == -7);
  CHECK(below->one_sided);
  CHECK_FALSE(plane->nearest({0, 0, 2}, 1));
  const auto entry = plane->entry({0, 0, 1}, {4, 0, -3}, 0);
  REQUIRE(entry);
  CHECK(entry->time == 0.25);
  CHECK(entry->point == Vec3(1, 0, 0));
  CHECK_FALSE(plane->entry({0, 0, -1}, {0, 0, -3}, 0));
  CHECK_FALSE(plane->entry({0, 0, 1}, {0, 0, 3}, 0));
  CHECK(plane->shadows({0, 0, -1}, Vec3::UnitZ()));
  CHECK_FALSE(plane->shadows({0, 0, 1}, Vec3::UnitZ()));
}

}  // namespace palpate::collision
