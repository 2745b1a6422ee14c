#include "studies/rigs/pressed_organ.h"

#include <catch2/catch.hpp>

#include "modules/geometry/primitives.h"
#include "palpate/session/in_process.h"

namespace palpate::rigs {
namespace {

scene::Scene plate_over_ball(std::vector<scene::ScriptedDevice::Move> moves) {
  scene::Scene scene;
  scene.organs.push_back({});
  scene.organs[0].name = "ball";
  scene.organs[0].fixed.push_back(scene::BoxRegion{{-1, -1, -1}, {1, 1, -0.03}});
  scene::ScriptedDevice device;
  device.start = Vec3(0, 0, 0.05);
  device.rotation = Quat(0, 1, 0, 0);
  device.moves = std::move(moves);
  scene.probes.push_back({"plate", scene::PlaneShape{}, 0.0, device});
  return scene;
}

TEST_CASE("pressed organ: a ball answers with the force the pipeline gives") {
  // Oracle: the in-process pipeline, which moves the same plate by a scripted device. Poses reach
  // deformation a period earlier here; at rest that is gone.
  const auto ball = geometry::make_ball(0.05, 2);
  const scene::Scene scene = plate_over_ball({{Vec3(0, 0, 0.042), 0.5}, {std::nullopt, 1.5}});
  session::InProcess pipeline(scene, {{ball}, {geometry::TriangleSurface{}}});
  pipeline.run_until(2);
  Pose pose;
  pose.position = Vec3(0, 0, 0.05);
  pose.rotation = Quat(0, 1, 0, 0);
  PressedOrgan pressed(scene, ball, {pose});
  for (int i = 1; i <= 100; ++i) {
    pose.position.z() = 0.05 - 0.008 * i / 100;
    pressed.advance({pose});
  }
  pressed.settle(3, [] {});
  const double expected = pipeline.contact_model(0).force().z();
  REQUIRE(expected > 0.03);
  CHECK(pressed.force(0).z() == Approx(expected).epsilon(0.005));
  CHECK(pressed.busy() > 0);
  CHECK(pressed.searching() > 0);
  CHECK(pressed.time() > 0.4);
  CHECK_FALSE(pressed.diverged());
}

TEST_CASE("pressed organ: untouched, nothing is felt and nothing moves") {
  // Oracle: rest.
  const scene::Scene scene = plate_over_ball({{std::nullopt, 1}});
  Pose pose;
  pose.position = Vec3(0, 0, 0.1);
  pose.rotation = Quat(0, 1, 0, 0);
  PressedOrgan pressed(scene, geometry::make_ball(0.05, 1), {pose});
  pressed.settle(0.2, [] {});
  CHECK(pressed.force(0) == Vec3::Zero());
  CHECK(pressed.changes() == 0);
  CHECK(pressed.skin().nodes == geometry::make_ball(0.05, 1).nodes);
  CHECK(pressed.skin().triangles == geometry::make_ball(0.05, 1).triangles);
  CHECK(pressed.encoding_of_mesh() > 0);
  CHECK(pressed.volume_error() <
        1e-6);  // float32 positions are not looked at, the volume is double
  for (std::size_t i = 0; i < pressed.node_count(); ++i) {
    CHECK((pressed.position(i) - pressed.rest_position(i)).norm() < 1e-8);
  }
}

}  // namespace
}  // namespace palpate::rigs
