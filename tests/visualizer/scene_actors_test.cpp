// Looked at through the renderer: VTK stays out of the tests.
#include <catch2/catch.hpp>

#include "tests/visualizer/display_or_skip.h"
#include "tests/visualizer/studio.h"

using namespace palpate;
using namespace palpate::visualizer;
using visualizer::testing::Picture;
using visualizer::testing::positions_of;
using visualizer::testing::Studio;
using visualizer::testing::topology_of;

TEST_CASE(
    "scene actors: springs, probes, forces and a new shape appear in the picture and go again",
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
  studio.view.receive(positions_of(studio.topology), 0);  // until then the old picture stays
  const Pixel was_organ = studio.pixel_of(Vec3(-0.045, 0, 0));
  CHECK(plain.at(was_organ.x, was_organ.y) != empty.at(was_organ.x, was_organ.y));
  CHECK(studio.draw().at(was_organ.x, was_organ.y) == empty.at(was_organ.x, was_organ.y));
}

TEST_CASE("scene actors: a probe behind the organ shines through", "[visualizer]") {
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

TEST_CASE("scene actors: moving nodes in place gives the picture that a new start gives",
          "[visualizer]") {
  // Oracle: identity with a renderer that has seen only the last positions.
  if (!visualizer::testing::xvfb_or_skip()) return;
  const auto picture_after = [](const std::vector<double>& places) {
    Studio studio;
    studio.interaction.options.springs[0] = true;
    Picture last;
    for (const double x : places) {
      studio.move_ball(Vec3(x, 0, 0));
      last = studio.draw();
    }
    return last;
  };
  CHECK(picture_after({0, 0.01, 0.02, 0.03}).differing(picture_after({0.03})) == 0);
}
