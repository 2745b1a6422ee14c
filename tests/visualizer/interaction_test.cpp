#include "visualizer/interaction.h"

#include <catch2/catch.hpp>

#include "tests/visualizer/fake_session.h"

using namespace palpate;
using namespace palpate::visualizer;
using visualizer::testing::two_probe_scene;
using Kind = InputEvent::Kind;

namespace {

/// A scene whose probes are 6 cm left (scripted) and right (mouse) of the middle.
struct Fixture {
  SceneView view{two_probe_scene()};
  Interaction interaction{{0.01, 0.036}};

  Fixture() {
    ProbeState probe;
    for (const double side : {-1, 1}) {
      probe.pose.position = Vec3(0.06 * side, 0, 0);
      probe.pose.rotation = Eigen::AngleAxisd(0.3 * side, Vec3::UnitX());
      view.receive(probe);
      probe.probe = 1;
    }
    interaction.camera = frontal_camera(Vec3::Zero(), 0.12, 900, 700);
  }

  Pixel pixel_of(std::size_t probe) const {
    return *project(interaction.camera, view.probes()[probe].pose.position);
  }
  Requests send(Kind kind, double x, double y, bool shift = false, bool control = false,
                MouseButton button = MouseButton::kLeft) {
    InputEvent event;
    event.kind = kind;
    event.x = x;
    event.y = y;
    event.shift = shift;
    event.control = control;
    event.button = button;
    return interaction.handle({event}, view);
  }
  Requests key(const std::string& name) {
    InputEvent event;
    event.kind = Kind::kKey;
    event.key = name;
    return interaction.handle({event}, view);
  }
};

}  // namespace

TEST_CASE("interaction: dragging a mouse probe asks for its new pose", "[visualizer][analytic]") {
  // Oracle: analytic projection; the rotation is kept.
  Fixture f;
  const Pixel at = f.pixel_of(1);
  f.send(Kind::kPress, at.x, at.y);
  REQUIRE(f.interaction.held_probe() == std::size_t{1});
  const auto requests = f.send(Kind::kMove, at.x - 40, at.y + 15);
  REQUIRE(requests.probe_input);
  CHECK(requests.probe_input->probe == 1);
  const auto now = project(f.interaction.camera, requests.probe_input->pose.position);
  CHECK(now->x == Approx(at.x - 40));
  CHECK(now->y == Approx(at.y + 15));
  CHECK(now->depth == Approx(at.depth));
  CHECK(requests.probe_input->pose.rotation.isApprox(f.view.probes()[1].pose.rotation));
  CHECK(f.interaction.handle({}, f.view).probe_input);  // as long as it is held
  f.send(Kind::kRelease, at.x, at.y);
  CHECK_FALSE(f.interaction.handle({}, f.view).probe_input);
}

TEST_CASE("interaction: ctrl-drag and wheel move the held probe along the view", "[visualizer]") {
  // Oracle: geometry of the frontal camera: only y changes.
  Fixture f;
  const Pixel at = f.pixel_of(1);
  f.send(Kind::kPress, at.x, at.y);
  const auto pushed = f.send(Kind::kMove, at.x + 30, at.y + 20, false, true);
  CHECK(pushed.probe_input->pose.position.y() > 0.001);
  CHECK(pushed.probe_input->pose.position.z() == Approx(0).margin(1e-12));
  InputEvent wheel;
  wheel.kind = Kind::kWheel;
  wheel.wheel_steps = -2;
  const auto pulled = f.interaction.handle({wheel}, f.view);
  CHECK(pulled.probe_input->pose.position.y() < pushed.probe_input->pose.position.y());
}

TEST_CASE("interaction: a probe with another device is not dragged, and the screen says so",
          "[visualizer]") {
  // Oracle: the stated rule.
  Fixture f;
  const Pixel at = f.pixel_of(0);
  f.send(Kind::kPress, at.x, at.y);
  CHECK_FALSE(f.interaction.held_probe());
  CHECK(f.interaction.notice() ==
        "Probe 'finger' does not follow the mouse: its device is not 'mouse'.");
  CHECK_FALSE(f.send(Kind::kMove, at.x + 9, at.y).probe_input);
  f.send(Kind::kPress, 450, 600);  // elsewhere
  CHECK(f.interaction.notice().empty());
}

TEST_CASE("interaction: shift-drag takes the mouse probe wherever it is", "[visualizer]") {
  // Oracle: the stated rule.
  Fixture f;
  f.send(Kind::kPress, 450, 600, true);
  CHECK(f.interaction.held_probe() == std::size_t{1});

  auto scene = two_probe_scene();
  scene.probes[1].device = scene::ScriptedDevice{};
  SceneView without(scene);
  Interaction other({0.01, 0.036});
  InputEvent press;
  press.kind = Kind::kPress;
  press.button = MouseButton::kLeft;
  press.shift = true;
  other.handle({press}, without);
  CHECK_FALSE(other.held_probe());
  CHECK(other.notice().find("device 'mouse'") != std::string::npos);
}

TEST_CASE("interaction: a mouse probe not heard of yet starts where the scene says",
          "[visualizer]") {
  // Oracle: the scene's start.
  const SceneView view(two_probe_scene());
  Interaction interaction({0.01, 0.036});
  InputEvent press;
  press.kind = Kind::kPress;
  press.button = MouseButton::kLeft;
  press.shift = true;
  const auto requests = interaction.handle({press}, view);
  REQUIRE(requests.probe_input);
  CHECK(requests.probe_input->pose.position.isApprox(Vec3(0.12, 0, 0)));
}

TEST_CASE("interaction: keys toggle and ask", "[visualizer]") {
  // Oracle: the key list shown by h.
  Fixture f;
  f.key("1");
  f.key("3");
  CHECK(f.interaction.options.springs == std::array<bool, 3>{true, false, true});
  f.key("1");
  CHECK(f.interaction.options.springs == std::array<bool, 3>{false, false, true});
  f.key("c");
  CHECK(f.interaction.options.coloring == Coloring::kDisplacement);
  f.key("c");
  CHECK(f.interaction.options.coloring == Coloring::kStrain);
  f.key("h");
  CHECK(f.interaction.options.help);
  CHECK(f.key("s").screenshot);
  CHECK(f.key("space").pause_or_resume);
  CHECK(f.key("r").reset);
  CHECK(f.key("q").close);
  const auto nothing = f.key("x");
  CHECK_FALSE((nothing.close || nothing.reset || nothing.screenshot || nothing.pause_or_resume));
}

TEST_CASE("interaction: dragging beside the probes moves the camera only", "[visualizer]") {
  // Oracle: invariants of orbit, pan and zoom.
  Fixture f;
  const Camera before = f.interaction.camera;
  f.send(Kind::kPress, 450, 600);
  CHECK_FALSE(f.send(Kind::kMove, 480, 590).probe_input);
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

TEST_CASE("interaction: closing the window asks to close", "[visualizer]") {
  // Oracle: the stated rule.
  Fixture f;
  CHECK(f.send(Kind::kClose, 0, 0).close);
}
