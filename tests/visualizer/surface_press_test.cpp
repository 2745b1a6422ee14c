#include "visualizer/surface_press.h"

#include <catch2/catch.hpp>

#include "modules/geometry/primitives.h"
#include "tests/visualizer/fake_session.h"

using namespace palpate;
using namespace palpate::visualizer;
using visualizer::testing::topology_of;
using visualizer::testing::two_probe_scene;

namespace {

constexpr double kBallRadius = 0.05, kTip = 0.008;

struct SeenBall {
  SceneView view{two_probe_scene()};
  Camera camera = frontal_camera(Vec3::Zero(), 0.1, 900, 700);

  SeenBall() { view.receive(topology_of(geometry::make_ball(kBallRadius, 3))); }
  SurfacePress press(const Vec3& from, const ProbeBody& body = ProbeBody(kTip)) const {
    return {0, body, {from, Quat::Identity()}, *pick_surface(view, camera, 450, 350), view, camera};
  }
};

/// Follows what is wanted until it does not change any more. @returns the points passed
std::vector<Vec3> travel(SurfacePress& press, Vec3 at) {
  std::vector<Vec3> passed{at};
  for (int i = 0; i < 10; ++i) {
    const Vec3 next = press.wanted(at).position;
    if ((next - at).norm() < 1e-12) break;
    passed.push_back(at = next);
  }
  return passed;
}

}  // namespace

TEST_CASE("surface press: the tip goes under the pointer, as deep as said",
          "[visualizer][analytic]") {
  // Oracle: geometry: the origin is the tip's radius less the depth above the place.
  const SeenBall f;
  SurfacePress press = f.press(Vec3(0, -0.1, 0));
  const auto height = [&] {
    const Vec3 at = travel(press, Vec3(0, -0.1, 0)).back();
    return (at - press.place().point).dot(press.place().normal);
  };
  CHECK(height() == Approx(kTip - SurfacePress::kFirstDepth));
  press.drag(0.01);
  const double dragged = SurfacePress::kFirstDepth + SurfacePress::kPerDrag * 0.01;
  CHECK(height() == Approx(kTip - dragged));
  press.deepen(0.002);
  CHECK(height() == Approx(kTip - dragged - 0.002));
  press.drag(10);
  CHECK(press.deepest());
  CHECK(press.depth() == Approx(SurfacePress::kDeepest * f.view.radius()));
  press.drag(0);
  press.deepen(-1);
  CHECK(press.depth() == Approx(-SurfacePress::kStandOff));
  const Vec3 off = press.stood_off().position - press.place().point;
  CHECK(off.dot(press.place().normal) == Approx(kTip + SurfacePress::kStandOff));
}

TEST_CASE("surface press: the way there passes through no organ", "[visualizer]") {
  // Oracle: the segments of the way against the surface, but for the last, which presses.
  const SeenBall f;
  for (const Vec3& from : {Vec3(0, -0.1, 0), Vec3(0.1, 0, 0), Vec3(0, 0.1, 0),
                           Vec3(0.02, 0.09, 0.01), Vec3(-0.03, 0.02, 0.08), Vec3(0, 0.08, -0.3)}) {
    SurfacePress press = f.press(from);
    const auto passed = travel(press, from);
    REQUIRE(passed.size() >= 2);
    for (std::size_t i = 0; i + 2 < passed.size(); ++i) {
      INFO(from.transpose() << ", part " << i);
      CHECK_FALSE(first_on_way(f.view, passed[i], passed[i + 1]));
    }
    CHECK((passed.back() - f.press(Vec3(0, -0.1, 0)).stood_off().position).norm() ==
          Approx(SurfacePress::kStandOff + SurfacePress::kFirstDepth));
  }
}

TEST_CASE(
    "surface press: a plane is turned to face the organ, a body presses with what is foremost",
    "[visualizer][analytic]") {
  // Oracle: geometry.
  const SeenBall f;
  ProbeBody plane;
  plane.plane = true;
  SurfacePress flat = f.press(Vec3(0, -0.2, 0), plane);
  const Pose pose = flat.stood_off();
  CHECK((pose.rotation * Vec3::UnitZ() + flat.place().normal).norm() < 1e-12);
  CHECK((pose.position - flat.place().point).norm() == Approx(SurfacePress::kStandOff));
  ProbeBody rod(0.03);
  rod.nodes = {Vec3(0, 0, -0.03), Vec3(0, 0.02, 0), Vec3(0, -0.01, 0)};
  CHECK(rod.support(Quat::Identity(), Vec3::UnitY()) == Approx(0.02));
  CHECK(rod.support(Quat::Identity(), -Vec3::UnitZ()) == Approx(0.03));
  CHECK(ProbeBody(0.004).support(Quat::Identity(), Vec3::UnitX()) == Approx(0.004));
}
