#include "deformation/law_of_probe.h"

#include <catch2/catch.hpp>

#include "deformation/world.h"
#include "organs.h"

namespace palpate::deformation {
namespace {

TEST_CASE("law of a probe: the local law goes on with a slow press") {
  // Oracle: the world's own force a period later. 20 % of what it grew by: a plate meets its nodes
  // one by one.
  auto organ = testing::ball_organ();
  organ.fixed.push_back(scene::BoxRegion{Vec3(-1, -1, -1), Vec3(1, 1, -0.03)});
  organ.tissue.drag = 10;
  DeformationWorld world(testing::ball_scene(1, organ),
                         {geometry::make_ball(testing::kBallRadius, 3)});
  const double way = 10e-3 * testing::kPeriod;
  double height = testing::kBallRadius;
  const auto press = [&] {
    height -= way;  // 10 mm/s
    world.set_contacts(testing::plate_contacts(world, 0, height, 1, 2e-3));
    world.set_probe(0, Pose{Vec3(0, 0, height), Quat::Identity()});
    world.advance(testing::kPeriod);
  };
  std::vector<Vec3> forces;
  while (height > testing::kBallRadius - 0.015) {
    press();
    forces.push_back(world.force(0));
  }
  const LocalLaw law = world.local_law(0);
  REQUIRE(law.touching());
  CHECK((law.anchor.position - Vec3(0, 0, height)).norm() < 1e-12);
  CHECK((law.force() - world.force(0)).norm() < 1e-12 * world.force(0).norm());
  CHECK(law.period == testing::kPeriod);
  CHECK(law.validity_radius > 0);
  for (const LawRow& row : law.rows) {
    CHECK(row.normal.z() == Approx(1).epsilon(1e-6));
    if (row.force.z() > 0) CHECK(row.velocity.z() == Approx(-10e-3).epsilon(0.01));
  }
  // Definition: of the last three periods, so that one that chatters counts for a third.
  const Vec3 &now = forces.back(), &then = forces[forces.size() - 4];
  CHECK(law.growth * testing::kPeriod == Approx((now - then).dot(now) / now.squaredNorm() / 3));
  press();
  const double grown = (world.force(0) - law.force()).z();
  CHECK(law.growth * testing::kPeriod * law.force().z() == Approx(grown).epsilon(0.2));
  const LocalLaw bare = without_rows(law);
  CHECK_FALSE(bare.touching());
  CHECK(bare.rows.empty());
  CHECK(bare.stiffness.isZero(0));
  CHECK(bare.anchor.position == law.anchor.position);
}

}  // namespace
}  // namespace palpate::deformation
