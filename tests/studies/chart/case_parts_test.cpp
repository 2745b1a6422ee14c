#include "studies/chart/case_parts.h"

#include <catch2/catch.hpp>

#include "modules/geometry/primitives.h"
#include "studies/rigs/squeezed_ball.h"

namespace palpate::chart {
namespace {

using rigs::kBallRadius;

TEST_CASE("case parts: the contact's radius is that of the touching nodes' share") {
  // Oracle: of a ball cut by a plane at height c, what lies above has the radius √(R² − c²); a
  // node's share is a third of its triangles, so an edge's length is not resolved.
  scene::Scene scene;
  scene.organs.push_back(solid_organ({}, kBallRadius, 1, kYoungsModulus, kDensity));
  rigs::PressedOrgan pressed(scene, geometry::OrganShape(geometry::make_ball(kBallRadius, 4)), {});
  for (const double height : {0.03, 0.04}) {
    const double radius =
        contact_radius(pressed, Vec3::UnitZ(), [&](const Vec3& x) { return height - x.z(); });
    CHECK(radius == Approx(std::sqrt(kBallRadius * kBallRadius - height * height)).epsilon(0.02));
  }
  CHECK(contact_radius(pressed, Vec3::UnitZ(), [](const Vec3&) { return 1.0; }) == 0);
}

}  // namespace
}  // namespace palpate::chart
