// Interaction's keys (visualizer/interaction_keys.cpp).
#include <catch2/catch.hpp>

#include "tests/visualizer/interaction_fixture.h"

using namespace palpate;
using namespace palpate::visualizer;
using visualizer::testing::Fixture;
using visualizer::testing::Kind;
using visualizer::testing::two_probe_scene;

TEST_CASE("interaction: keys toggle and ask", "[visualizer]") {
  // Oracle: the key list shown by h.
  Fixture f;
  f.add_ball();
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
  CHECK(f.key("q").end_run);
  CHECK(f.key("n").step);
  CHECK(f.key("m").slow_motion);
  CHECK(f.key("v").record);
  f.key("w");
  CHECK(f.interaction.options.wireframe);
  f.key("x");
  f.key("period");
  CHECK(f.interaction.options.cut == Approx(0.1));
  for (int i = 0; i < 30; ++i) f.key("comma");
  CHECK(f.interaction.options.cut == Approx(-1));
  f.key("x");
  CHECK_FALSE(f.interaction.options.cut);
}

TEST_CASE("interaction: a key that does nothing here says so, a modifier does not",
          "[visualizer]") {
  // Oracle: the stated rule; the ball has no bending springs and is no solid.
  Fixture f;
  f.add_ball();
  const std::vector<std::pair<std::string, std::string>> said{
      {"b", "Key 'b' does nothing here; h lists those that do."},
      {"2", "No organ here has bending springs."},
      {"t", "No organ here is made of tetrahedra: 1 2 3 show its springs."},
      {"comma", "There is no plane to move: x cuts."}};
  for (const auto& [key, line] : said) {
    const auto requests = f.key(key);
    CHECK(f.interaction.notice() == line);
    CHECK_FALSE((requests.close || requests.reset || requests.screenshot ||
                 requests.pause_or_resume || requests.step || requests.record));
    f.key("Shift_L");
    CHECK(f.interaction.notice() == line);
    f.key("h");
    CHECK(f.interaction.notice().empty());
  }
  CHECK_FALSE(f.interaction.options.springs[1]);
}

TEST_CASE("interaction: where hands are off, neither keys conduct nor drags press",
          "[visualizer]") {
  // Oracle: nothing is asked for, and the screen says why; the camera turns.
  Fixture f;
  f.add_ball();
  f.interaction.hands_off = "Not here.";
  for (const char* key : {"space", "n", "m", "r", "v", "g"}) {
    const auto requests = f.key(key);
    CHECK_FALSE((requests.pause_or_resume || requests.step || requests.slow_motion ||
                 requests.reset || requests.record));
    CHECK(f.interaction.notice() == "Not here.");
  }
  const Camera before = f.interaction.camera;
  CHECK(f.send(Kind::kPress, 450, 350).probe_inputs.empty());
  f.send(Kind::kMove, 480, 360);
  CHECK_FALSE(f.interaction.camera.position.isApprox(before.position));
}

TEST_CASE("interaction: in a narrow window home shows as much as in a usual one", "[visualizer]") {
  // Oracle: projection: what is at the edge of the usual picture is at the edge of the narrow one.
  auto scene = two_probe_scene();
  scene.camera.position = Vec3(-0.2, -0.5, 0.1);
  scene.camera.target = Vec3(0.01, 0, 0);
  const SceneView view(scene);
  const Camera usual = home_camera(view, 920, 720), narrow = home_camera(view, 384, 480);
  CHECK(usual.position.isApprox(*scene.camera.position));
  CHECK(home_camera(view, 1840, 1440).position.isApprox(*scene.camera.position));
  const double half = 460 * usual.pixel_size((usual.target - usual.position).norm());
  const double seen = 192 * narrow.pixel_size((narrow.target - narrow.position).norm());
  CHECK(seen == Approx(half));
}

TEST_CASE("interaction: home is the camera of the start", "[visualizer]") {
  // Oracle: the scene's camera, else all organs from the front.
  Fixture f;
  f.add_ball();
  f.key("Home");
  const Camera home = f.interaction.camera;
  CHECK(home.position.isApprox(
      frontal_camera(f.view.center(), 1.25 * f.view.radius(), 900, 700).position));
  f.send(Kind::kPress, 450, 600, false, false, MouseButton::kMiddle);
  f.send(Kind::kMove, 480, 590);
  CHECK_FALSE(f.interaction.camera.position.isApprox(home.position));
  f.key("0");
  CHECK(f.interaction.camera.position == home.position);
  CHECK(f.interaction.camera.target == home.target);
}
