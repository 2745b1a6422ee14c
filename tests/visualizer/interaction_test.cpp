#include "visualizer/interaction.h"

#include <catch2/catch.hpp>

#include "tests/visualizer/interaction_fixture.h"

using namespace palpate;
using namespace palpate::visualizer;
using visualizer::testing::Fixture;
using visualizer::testing::Kind;
using visualizer::testing::two_probe_scene;

TEST_CASE("interaction: dragging a mouse probe asks for its new pose", "[visualizer][analytic]") {
  // Oracle: analytic projection; the rotation is kept.
  Fixture f;
  const Pixel at = f.pixel_of(1);
  f.send(Kind::kPress, at.x, at.y);
  REQUIRE(f.interaction.held_probe() == std::size_t{1});
  const auto requests = f.send(Kind::kMove, at.x - 40, at.y + 15);
  REQUIRE(requests.probe_inputs.size() == 1);
  CHECK(requests.probe_inputs.at(0).probe == 1);
  const auto now = project(f.interaction.camera, requests.probe_inputs.at(0).pose.position);
  CHECK(now->x == Approx(at.x - 40));
  CHECK(now->y == Approx(at.y + 15));
  CHECK(now->depth == Approx(at.depth));
  CHECK(requests.probe_inputs.at(0).pose.rotation.isApprox(f.view.probes()[1].pose.rotation));
  f.send(Kind::kRelease, at.x, at.y);
  const auto after = f.interaction.handle({}, f.view);
  REQUIRE(after.probe_inputs.size() == 1);  // it stays where it was put
  CHECK(after.probe_inputs[0].pose.position == requests.probe_inputs[0].pose.position);
  CHECK_FALSE(f.interaction.held_probe());
}

TEST_CASE("interaction: ctrl-drag and wheel move the held probe along the view", "[visualizer]") {
  // Oracle: geometry of the frontal camera: only y changes.
  Fixture f;
  const Pixel at = f.pixel_of(1);
  f.send(Kind::kPress, at.x, at.y);
  const auto pushed = f.send(Kind::kMove, at.x + 30, at.y + 20, false, true);
  CHECK(pushed.probe_inputs.at(0).pose.position.y() > 0.001);
  CHECK(pushed.probe_inputs.at(0).pose.position.z() == Approx(0).margin(1e-12));
  InputEvent wheel;
  wheel.kind = Kind::kWheel;
  wheel.wheel_steps = -2;
  const auto pulled = f.interaction.handle({wheel}, f.view);
  CHECK(pulled.probe_inputs.at(0).pose.position.y() < pushed.probe_inputs.at(0).pose.position.y());
}

TEST_CASE("interaction: a probe moved by its own device is not taken, and the screen says so",
          "[visualizer]") {
  // Oracle: the stated rule.
  auto scene = two_probe_scene();
  scene.probes[0].device = scene::TopicDevice{};
  scene.probes[1].device = scene::EmulatedDevice{};
  Fixture f(scene);
  const Pixel at = f.pixel_of(0);
  f.send(Kind::kPress, at.x, at.y);
  CHECK_FALSE(f.interaction.held_probe());
  CHECK(f.interaction.notice() == "Probe 'finger' is moved by its own device, not by the mouse.");
  CHECK(f.send(Kind::kMove, at.x + 9, at.y).probe_inputs.empty());
  f.send(Kind::kPress, 450, 600);  // elsewhere
  CHECK(f.interaction.notice().empty());
  f.add_ball();
  f.send(Kind::kPress, 450, 350, true);
  CHECK_FALSE(f.interaction.held_probe());
  CHECK(f.interaction.notice() == "Every probe of this scene is moved by its own device.");
}

TEST_CASE("interaction: a drag on an organ presses it with the mouse's probe, and lets go",
          "[visualizer]") {
  // Oracle: the place under the pointer; the depth is SurfacePress's.
  Fixture f;
  f.add_ball();
  f.send(Kind::kPress, 450, 350);
  CHECK(f.interaction.held_probe() == std::size_t{1});
  const SurfacePress* press = f.interaction.surface_press();
  REQUIRE(press != nullptr);
  CHECK((press->place().point - Vec3(0, -0.03, 0)).norm() < 1e-3);
  const double first = press->depth();
  f.send(Kind::kMove, 480, 350);
  CHECK(press->depth() > first + 1e-3);
  const double dragged = press->depth();
  InputEvent wheel;
  wheel.kind = Kind::kWheel;
  wheel.wheel_steps = 2;
  f.interaction.handle({wheel}, f.view);
  CHECK(press->depth() == Approx(dragged + 2e-3));
  const Vec3 before = press->place().point;
  f.send(Kind::kMove, 500, 350, false, true);  // slides
  CHECK(press->depth() == Approx(dragged + 2e-3));
  CHECK(press->place().point.x() > before.x() + 1e-3);
  const Vec3 off = press->stood_off().position;
  const auto released = f.send(Kind::kRelease, 500, 350);
  CHECK_FALSE(f.interaction.held_probe());
  REQUIRE(released.probe_inputs.size() == 1);
  CHECK(released.probe_inputs[0].pose.position == off);
}

TEST_CASE("interaction: a script's probe is taken over where there is no other, and given back",
          "[visualizer]") {
  // Oracle: what is asked for: poses while it is taken, silence after.
  auto scene = two_probe_scene();
  scene.probes[1].device = scene::TopicDevice{};
  Fixture f(scene);
  f.add_ball();
  const auto pressed = f.send(Kind::kPress, 450, 350, true);
  REQUIRE(pressed.probe_inputs.size() == 1);
  CHECK(pressed.probe_inputs[0].probe == 0);
  CHECK(f.interaction.taken(0));
  f.send(Kind::kRelease, 450, 350);
  CHECK(f.interaction.handle({}, f.view).probe_inputs.size() == 1);
  CHECK(f.key("g").probe_inputs.empty());
  CHECK_FALSE(f.interaction.taken(0));
  CHECK(f.interaction.notice() == "Given back: finger");
  f.key("g");
  CHECK(f.interaction.notice() == "No probe is taken over: there is none to give back.");
}

TEST_CASE("interaction: a mouse's probe that is given back goes where the scene starts it",
          "[visualizer]") {
  // Oracle: the scene's start.
  Fixture f;
  f.add_ball();
  f.send(Kind::kPress, 450, 350);
  f.send(Kind::kRelease, 450, 350);
  const auto requests = f.key("g");
  REQUIRE(requests.probe_inputs.size() == 1);
  CHECK(requests.probe_inputs.at(0).pose.position.isApprox(Vec3(0.12, 0, 0)));
}

TEST_CASE("interaction: shift-drag beside all organs says what it is for", "[visualizer]") {
  // Oracle: the stated rule.
  Fixture f;
  f.send(Kind::kPress, 450, 600, true);
  CHECK_FALSE(f.interaction.held_probe());
  CHECK(f.interaction.notice() == "No organ under the pointer: shift-drag presses one.");
}

TEST_CASE("interaction: a reset takes the hand off", "[visualizer]") {
  // Oracle: no pose is asked for any more.
  Fixture f;
  f.add_ball();
  f.send(Kind::kPress, 450, 350);
  const auto requests = f.key("r");
  CHECK(requests.reset);
  CHECK(requests.probe_inputs.empty());
}

TEST_CASE("interaction: dragging beside the probes moves the camera only", "[visualizer]") {
  // Oracle: invariants of orbit, pan and zoom.
  Fixture f;
  const Camera before = f.interaction.camera;
  f.send(Kind::kPress, 450, 600);
  CHECK(f.send(Kind::kMove, 480, 590).probe_inputs.empty());
  CHECK_FALSE(f.interaction.camera.position.isApprox(before.position));
  CHECK(f.interaction.camera.target.isApprox(before.target));
  f.send(Kind::kRelease, 480, 590);
  f.send(Kind::kPress, 450, 600, false, false, MouseButton::kMiddle);
  f.send(Kind::kMove, 460, 600);
  CHECK_FALSE(f.interaction.camera.target.isApprox(before.target));
  f.send(Kind::kRelease, 460, 600);
  const double distance = (f.interaction.camera.position - f.interaction.camera.target).norm();
  f.send(Kind::kPress, 450, 600, false, false, MouseButton::kRight);
  f.send(Kind::kMove, 450, 660);
  CHECK((f.interaction.camera.position - f.interaction.camera.target).norm() < distance);
}

TEST_CASE("interaction: presses on the panel beside the 3-D part do nothing", "[visualizer]") {
  // Oracle: the stated rule.
  Fixture f;
  const Camera before = f.interaction.camera;
  f.send(Kind::kPress, 1000, 600);
  f.send(Kind::kMove, 1050, 500);
  CHECK(f.interaction.camera.position.isApprox(before.position));
}

TEST_CASE("interaction: closing the window ends the run, as q does", "[visualizer]") {
  // Oracle: the stated rule.
  Fixture f;
  const Requests requests = f.send(Kind::kClose, 0, 0);
  CHECK(requests.close);
  CHECK(requests.end_run);
}
