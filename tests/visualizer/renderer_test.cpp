#include "visualizer/renderer.h"

#include <catch2/catch.hpp>
#include <filesystem>
#include <fstream>

#include "modules/geometry/primitives.h"
#include "tests/visualizer/display_or_skip.h"
#include "tests/visualizer/fake_session.h"
#include "visualizer/offscreen_display.h"
#include "visualizer/probe_shape.h"

using namespace palpate;
using namespace palpate::visualizer;
using visualizer::testing::positions_of;
using visualizer::testing::topology_of;
using visualizer::testing::two_probe_scene;

namespace {

constexpr int kWidth = 640, kHeight = 400;

struct Picture {
  std::vector<std::uint8_t> pixels;

  Rgb at(double x, double y) const {
    const std::size_t i = 3 * (std::size_t(y) * kWidth + std::size_t(x));
    return {pixels[i], pixels[i + 1], pixels[i + 2]};
  }
  std::size_t differing(const Picture& other) const {
    std::size_t count = 0;
    for (std::size_t i = 0; i < pixels.size(); i += 3) {
      count += pixels[i] != other.pixels[i] || pixels[i + 1] != other.pixels[i + 1] ||
               pixels[i + 2] != other.pixels[i + 2];
    }
    return count;
  }
};

/// A ball of 5 cm about the origin, seen off-screen from the front.
struct Studio {
  OffscreenDisplay display;
  scene::Scene scene = two_probe_scene();
  SceneView view{scene};
  SurfaceTopology topology = topology_of(geometry::make_ball(0.05, 3));
  Interaction interaction{{0.01, 0.036}};
  Layout layout = make_layout(kWidth, kHeight);
  Renderer renderer{
      {kWidth, kHeight, false, "test"},
      {probe_surface(scene.probes[0].shape, 1, {}), probe_surface(scene.probes[1].shape, 1, {})}};

  Studio() {
    interaction.camera =
        frontal_camera(Vec3::Zero(), 0.12, int(layout.scene.width), int(layout.scene.height));
    view.receive(topology);
  }

  Picture draw(bool overlay = false) {
    view.refresh();
    const DrawList list = make_draw_list(view, interaction.options);
    renderer.draw(list, overlay ? make_overlay(view, list, interaction, layout, 1) : Overlay{},
                  interaction.camera);
    return {renderer.pixels()};
  }
  /// The background: the organ is far behind the eye.
  Picture draw_nothing() {
    Camera away = interaction.camera;
    away.target = away.position + (away.position - away.target);
    renderer.draw(make_draw_list(view, {}), Overlay{}, away);
    return {renderer.pixels()};
  }
  void move_ball(const Vec3& by) {
    auto positions = positions_of(topology, 1);
    for (std::size_t i = 0; i < positions.positions.size(); ++i) {
      positions.positions[i] += static_cast<float>(by[static_cast<int>(i % 3)]);
    }
    view.receive(positions, 1);
  }
  Pixel pixel_of(const Vec3& p) const { return *project(interaction.camera, p); }
};

}  // namespace

TEST_CASE("renderer: the organ is where the camera projects it, and moves with it",
          "[visualizer]") {
  // Oracle: analytic projection of the ball's middle and of places beside its outline.
  if (!visualizer::testing::xvfb_or_skip()) return;
  Studio studio;
  const Picture empty = studio.draw_nothing();
  const Picture rest = studio.draw();
  REQUIRE(rest.pixels.size() == std::size_t{3} * kWidth * kHeight);
  const auto covered = [&](const Picture& picture, const Vec3& p) {
    const Pixel pixel = studio.pixel_of(p);
    return picture.at(pixel.x, pixel.y) != empty.at(pixel.x, pixel.y);
  };
  for (const Vec3& inside : {Vec3(0, 0, 0), Vec3(0.045, 0, 0), Vec3(-0.045, 0, 0),
                             Vec3(0, 0, 0.045), Vec3(0, 0, -0.045)}) {
    CHECK(covered(rest, inside));
  }
  for (const Vec3& outside :
       {Vec3(0.056, 0, 0), Vec3(-0.056, 0, 0), Vec3(0, 0, 0.056), Vec3(0, 0, -0.056)}) {
    CHECK_FALSE(covered(rest, outside));
  }
  const Rgb middle = rest.at(studio.pixel_of(Vec3::Zero()).x, studio.pixel_of(Vec3::Zero()).y);
  CHECK(middle[0] > middle[2] + 20);  // lit tissue is pink; the background is bluish
  studio.move_ball(Vec3(0.04, 0, 0));
  const Picture moved = studio.draw();
  CHECK(covered(moved, Vec3(0.08, 0, 0)));
  CHECK_FALSE(covered(moved, Vec3(-0.03, 0, 0)));
}

TEST_CASE("renderer: the same state gives the same picture", "[visualizer]") {
  // Oracle: identity.
  if (!visualizer::testing::xvfb_or_skip()) return;
  Studio studio;
  const Picture first = studio.draw(true);
  CHECK(studio.draw(true).differing(first) == 0);
}

TEST_CASE("renderer: springs, probes, forces and a new shape appear in the picture and go again",
          "[visualizer]") {
  // Oracle: pictures differ where something was added, and are equal after taking it away.
  if (!visualizer::testing::xvfb_or_skip()) return;
  Studio studio;
  const Picture plain = studio.draw();
  for (std::size_t family : {0u, 2u}) {
    studio.interaction.options.springs[family] = true;
    INFO("family " << family);
    CHECK(studio.draw().differing(plain) > 500);
    studio.interaction.options.springs[family] = false;
    CHECK(studio.draw().differing(plain) == 0);
  }
  ProbeState probe;
  probe.pose.position = Vec3(0.08, 0, 0.03);
  studio.view.receive(probe);
  const Picture with_probe = studio.draw();
  const Pixel at = studio.pixel_of(probe.pose.position);
  CHECK(with_probe.at(at.x, at.y) != plain.at(at.x, at.y));
  HapticForce force;
  force.force = Vec3(0, 0, -1);
  studio.view.receive(force);
  CHECK(studio.draw().differing(with_probe) > 50);
  const Picture empty = studio.draw_nothing();
  studio.topology = topology_of(geometry::make_ball(0.03, 2), 2);
  studio.view.receive(studio.topology);
  const Pixel was_organ = studio.pixel_of(Vec3(-0.045, 0, 0));
  CHECK(plain.at(was_organ.x, was_organ.y) != empty.at(was_organ.x, was_organ.y));
  CHECK(studio.draw().at(was_organ.x, was_organ.y) == empty.at(was_organ.x, was_organ.y));
}

TEST_CASE("renderer: a probe behind the organ shines through", "[visualizer]") {
  // Oracle: the picture differs at the hidden probe's pixel.
  if (!visualizer::testing::xvfb_or_skip()) return;
  Studio studio;
  const Picture plain = studio.draw();
  ProbeState probe;
  probe.pose.position = Vec3(0, 0.07, 0);
  studio.view.receive(probe);
  const Pixel at = studio.pixel_of(probe.pose.position);
  CHECK(studio.draw().at(at.x, at.y) != plain.at(at.x, at.y));
}

TEST_CASE("renderer: text and plots are painted beside the organ", "[visualizer]") {
  // Oracle: pictures with and without the flat part differ, mostly in the right-hand panel.
  if (!visualizer::testing::xvfb_or_skip()) return;
  Studio studio;
  CHECK(studio.draw(true).differing(studio.draw(false)) > 2000);
}

TEST_CASE("renderer: writes a PNG or says which file it could not write", "[visualizer][fault]") {
  // Oracle: the PNG signature; the message.
  if (!visualizer::testing::xvfb_or_skip()) return;
  Studio studio;
  studio.draw(true);
  const auto folder = std::filesystem::temp_directory_path() /
                      ("palpate_renderer_test_" + std::to_string(getpid()));
  std::filesystem::create_directory(folder);
  studio.renderer.write_png(folder / "picture.png");
  std::ifstream file(folder / "picture.png", std::ios::binary);
  std::string start(8, '\0');
  file.read(start.data(), 8);
  CHECK(start == "\x89PNG\r\n\x1a\n");
  const auto nowhere = folder / "missing" / "picture.png";
  CHECK_THROWS_WITH(studio.renderer.write_png(nowhere), "cannot write picture " + nowhere.string());
  CHECK(std::distance(std::filesystem::directory_iterator(folder), {}) == 1);  // no half file
  std::filesystem::remove_all(folder);
}
