#include "studies/rigs/squeezed_ball.h"

#include <catch2/catch.hpp>
#include <set>

#include "modules/geometry/primitives.h"
#include "studies/rigs/test_body.h"
#include "tests/deformation/plate_contacts.h"

namespace palpate::rigs {
namespace {

TEST_CASE("squeezed ball: plates face each other") {
  // Oracle: a plane is solid below its own z = 0.
  CHECK(plate_pose(0.1, true).to_world(Vec3::UnitZ()).z() > 0.1);
  CHECK(plate_pose(0.1, false).to_world(Vec3::UnitZ()).z() < 0.1);
}

TEST_CASE("squeezed ball: a plate has one contact with each node near it") {
  // Oracle: brute force over the rest positions, which float32 rounds by no more than 4e-9 m.
  const auto ball = geometry::make_ball(kBallRadius, 2);
  scene::Scene scene;
  scene.organs.push_back(ball_organ());
  add_plates(scene);
  const deformation::DeformationWorld world(scene, {ball});
  constexpr double kHeight = 0.045, kMargin = 2e-3;
  for (const int side : {1, -1}) {
    const ContactSet contacts =
        deformation::testing::plate_contacts(world, 0, side * kHeight, side, kMargin);
    std::set<std::uint32_t> touched;
    for (const Contact& contact : contacts.contacts) {
      int corner = 0;
      CHECK(contact.barycentric.maxCoeff(&corner) == 1);
      const auto node = ball.triangles[contact.triangle][static_cast<std::size_t>(corner)];
      CHECK(touched.insert(node).second);
      CHECK(contact.gap == Approx(kHeight - side * ball.nodes[node].z()).margin(1e-8));
    }
    std::size_t near = 0;
    for (const Vec3& x : ball.nodes) near += kHeight - side * x.z() <= kMargin;
    CHECK(touched.size() == near);
    CHECK(near > 5);
  }
}

TEST_CASE("squeezed ball: the equator of a ball at rest is its own") {
  // Oracle: analytic; edges of an icosphere lie below the sphere by (edge/2)²/2R, 0.6 % here.
  const auto ball = geometry::make_ball(kBallRadius, 3);
  const double radius =
      equatorial_radius(ball.triangles, [&](std::size_t i) { return ball.nodes[i]; });
  CHECK(radius == Approx(kBallRadius).epsilon(6e-3));
}

TEST_CASE("squeezed ball: held between plates, it fills what they leave and pushes back") {
  // Oracle: invariant. No node is beyond a plate; the upper plate feels about pressure times area.
  auto organ = ball_organ();
  organ.tissue.drag = 10;
  TestBody ball(organ, geometry::make_ball(kBallRadius, 3));
  Plates plates(ball.model(), kBallRadius);
  const double h = ball.dynamics().largest_step();
  for (double t = h; t < 3; t += h) {
    plates.step(ball.dynamics(), h, kBallRadius * (1 - 0.3 * minimum_jerk(t)), ball.state());
  }
  double highest = 0;
  for (const Vec3& x : ball.state().positions) highest = std::max(highest, x.z());
  CHECK(highest == Approx(0.7 * kBallRadius).epsilon(1e-4));
  const double carried = ball.state().pressure * plates.contact_area(ball.state());
  CHECK(plates.force() > 0.5 * carried);
  CHECK(plates.force() < 2 * carried);
}

}  // namespace
}  // namespace palpate::rigs
