#include "collision/relative_motion.h"

#include <catch2/catch.hpp>

#include "tests/collision/random_shapes.h"

namespace palpate::collision {

TEST_CASE("relative motion: takes world points into the probe's frame") {
  // Oracle: Pose's own transformations.
  RandomShapes random(41);
  for (int trial = 0; trial < 50; ++trial) {
    const ProbeMotion motion{{random.point(1), random.rotation()},
                             {random.point(1), random.rotation()}};
    const RelativeMotion relative(motion, 0.1, false);
    const Vec3 p = random.point(1);
    CHECK((relative.start(p) - motion.pose_t0.to_body(p)).norm() < 1e-14);
    CHECK((relative.end(p) - motion.pose_t1.to_body(p)).norm() < 1e-14);
    const RelativeMotion round(motion, 0.1, true);
    CHECK(round.end(p) == relative.end(p));
    const Pose held{motion.pose_t0.position, motion.pose_t1.rotation};
    CHECK((round.start(p) - held.to_body(p)).norm() < 1e-14);
    CHECK(round.chord_error() == 0);
  }
}

TEST_CASE("relative motion: no resting point strays further from its chord than said") {
  // Oracle: brute force; the exact way of a point in the turning frame, sampled.
  RandomShapes random(42);
  for (int trial = 0; trial < 100; ++trial) {
    const double angle = random.number(0, 1), reach = 0.05;
    const Vec3 axis = random.direction(), way = random.point(0.05);
    const Quat start = random.rotation(), end(Quat(Eigen::AngleAxisd(angle, axis)) * start);
    const RelativeMotion relative({{Vec3::Zero(), start}, {way, end}}, reach, false);
    const Vec3 p = 0.5 * way + random.direction() * random.number(0, 0.5 * reach);
    for (double t = 0.1; t < 1; t += 0.1) {
      const Pose pose{t * way, start.slerp(t, end)};
      const Vec3 exact = pose.to_body(p);
      if (exact.norm() > reach) continue;
      const Vec3 chord = relative.start(p) + t * (relative.end(p) - relative.start(p));
      CHECK((exact - chord).norm() <= relative.chord_error() + 1e-15);
    }
  }
}

TEST_CASE("relative motion: the swept bounds hold the box at both ends") {
  // Oracle: brute force over the corners.
  RandomShapes random(43);
  const Bounds box{Vec3(-0.1, -0.2, 0), Vec3(0.1, 0.3, 0.5)};
  for (int trial = 0; trial < 50; ++trial) {
    const ProbeMotion motion{{random.point(1), random.rotation()},
                             {random.point(1), random.rotation()}};
    Bounds swept = RelativeMotion(motion, 1, false).swept(box), corners;
    for (int k = 0; k < 8; ++k) {
      const Vec3 corner(k & 1 ? box.lower[0] : box.upper[0], k & 2 ? box.lower[1] : box.upper[1],
                        k & 4 ? box.lower[2] : box.upper[2]);
      corners.add(motion.pose_t0.to_world(corner));
      corners.add(motion.pose_t1.to_world(corner));
    }
    CHECK((swept.lower - corners.lower).norm() < 1e-14);
    CHECK((swept.upper - corners.upper).norm() < 1e-14);
  }
}

TEST_CASE("organ step: a triangle's way, normal and the normals around it") {
  // Oracle: analytic; a unit tetrahedron at rest, the probe moves up by 2.
  const std::vector<Vec3> nodes{Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)};
  OrganSurface organ({{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}});
  organ.update(nodes);
  const RelativeMotion motion({{}, {Vec3(0, 0, 2), Quat::Identity()}}, 0.1, false);
  const OrganStep step{0, organ, motion, 0, 0.1, 1};
  SweptTriangle triangle;
  REQUIRE(step.sweep(0, triangle));
  CHECK(triangle.travel == Approx(2));
  CHECK(triangle.travel >= 2);
  CHECK(triangle.normal_end == Vec3(0, 0, -1));
  CHECK(triangle.at(0.5)[0] == Vec3(0, 0, -1));
  CHECK(triangle.bounds().lower == Vec3(0, 0, -2));
  CHECK(triangle.bounds().upper == Vec3(1, 1, 0));
  CHECK(step.node_normal_end(0) == Vec3(-0.5, -0.5, -0.5));
  // Edge 0–1 lies between the triangles facing −z and −y.
  CHECK(step.edge_normal_end(organ.edges_of_triangle(1)[0]) == Vec3(0, -0.5, -0.5));
  CHECK(step.edge_normal_start(organ.edges_of_triangle(1)[0]) == Vec3(0, -0.5, -0.5));
}

}  // namespace palpate::collision
