#include "collision/approach.h"

#include <catch2/catch.hpp>

#include "modules/geometry/primitives.h"

namespace palpate::collision {
namespace {

constexpr double kBall = 0.05, kTip = 0.004;  // radii [m]

Approach down_to(double height, double speed, double duration, const Vec3& aside = Vec3::Zero()) {
  const geometry::TriangleSurface ball = geometry::make_ball(kBall, 4);
  const auto pose_at = [&](double time) {
    Pose pose;
    pose.position = aside + Vec3(0, 0, std::max(height, 0.1 - speed * time));
    return pose;
  };
  return approach_of(geometry::RoundedSegment{Vec3::Zero(), Vec3::Zero(), kTip}, {ball}, pose_at,
                     duration);
}

TEST_CASE("approach: a sphere that comes down on a ball touches when the distance is used up") {
  // Oracle: analytic: 100 mm less both radii at the speed; looks are 10 ms apart, and a ball of
  // triangles is up to 0.1 mm inside the sphere.
  for (const double speed : {0.01, 0.1, 1.0}) {
    const Approach approach = down_to(0.03, speed, 10);
    REQUIRE(approach.touches_at);
    const double when = (0.1 - kBall - kTip) / speed;
    CHECK(*approach.touches_at >= when - 1e-9);
    CHECK(*approach.touches_at <= when + kLookEvery + 1e-4 / speed);
    CHECK_FALSE(approach.begins_inside);
    CHECK(approach.fastest == Approx(speed));
    CHECK(approach.extent == Approx(std::min(0.07, speed * 10)));
  }
}

TEST_CASE("approach: what passes by is told how near it came, what begins inside that it does") {
  // Oracle: analytic.
  const Approach passes = down_to(-0.1, 0.1, 3, Vec3(0.08, 0, 0));
  CHECK_FALSE(passes.touches_at);
  CHECK(passes.nearest == Approx(0.03).margin(2e-4));
  CHECK(passes.nearest_at == Approx(1).margin(0.1));
  CHECK(passes.duration == 3);
  CHECK(down_to(0, 100, 0.1).touches_at);
  const Approach inside = approach_of(
      geometry::RoundedSegment{Vec3::Zero(), Vec3::Zero(), kTip}, {geometry::make_ball(kBall, 3)},
      [](double) { return Pose(); }, 0.1);
  CHECK(inside.begins_inside);
}

}  // namespace
}  // namespace palpate::collision
