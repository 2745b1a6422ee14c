#include "collision/probe_model.h"

#include <catch2/catch.hpp>

#include "modules/geometry/primitives.h"

namespace palpate::collision {

TEST_CASE("probe model: every form has what its searches need, and its bounds") {
  // Oracle: analytic.
  const ProbeModel sphere(geometry::RoundedSegment{Vec3::Zero(), Vec3::Zero(), 0.5});
  CHECK(sphere.is_round);
  CHECK(sphere.cores.size() == 1);
  CHECK(sphere.cores[0].is_point());
  CHECK(sphere.reach == 0.5);
  CHECK(sphere.max_tracked_penetration == 1);
  CHECK_FALSE(sphere.solid);

  const ProbeModel capsule(geometry::RoundedSegment{-Vec3::UnitZ(), Vec3::UnitZ(), 0.5});
  CHECK_FALSE(capsule.is_round);
  REQUIRE(capsule.cores.size() == 3);
  CHECK(capsule.cores[0].b == Vec3(0, 0, 1));
  CHECK(capsule.hull.upper == Vec3(0, 0, 1));
  CHECK(capsule.hull_radius == 0.5);
  CHECK(capsule.reach == 1.5);
  CHECK(capsule.max_tracked_penetration == 3);

  const ProbeModel box(geometry::Box{Vec3(2, 4, 4)});
  CHECK(box.cores.empty());
  REQUIRE(box.sharp);
  CHECK(box.sharp->vertices().size() == 8);
  CHECK(box.sharp->edges().size() == 12);
  CHECK(box.hull.lower == Vec3(-1, -2, -2));
  CHECK(box.reach == 3);

  const ProbeModel plane(geometry::HalfSpace{});
  CHECK_FALSE(plane.is_bounded);
  CHECK(plane.hull.upper[2] == 0);
  CHECK(plane.solid);
  CHECK_FALSE(plane.sharp);

  const Vec3 aside(0.5, 0, 0);
  const ProbeModel beside(geometry::RoundedSegment{aside, aside, 0.5});
  CHECK_FALSE(beside.is_round);
  CHECK(beside.cores.size() == 1);
  CHECK(beside.hull.lower == aside);
  CHECK(beside.reach == 1);

  auto off_center = geometry::make_box({2, 2, 2});
  for (Vec3& x : off_center.nodes) x[0] += 5;
  const ProbeModel mesh(off_center);
  CHECK(mesh.solid);
  CHECK(mesh.hull.lower == Vec3(4, -1, -1));
  CHECK(mesh.reach == Approx(std::sqrt(38.0)));
  CHECK(mesh.max_tracked_penetration == 2);
}

}  // namespace palpate::collision
