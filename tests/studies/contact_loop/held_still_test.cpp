// Tools that nobody moves, or that slide onto what is fixed.
#include <algorithm>
#include <catch2/catch.hpp>

#include "modules/core/data_folder.h"
#include "modules/geometry/winding_number.h"
#include "modules/scene/scene_reader.h"
#include "palpate/session/in_process.h"
#include "studies/rigs/pressed_organ.h"

namespace palpate::contact_loop {
namespace {

TEST_CASE("contact loop: a box that is held still in a spring shell feels a steady force") {
  // Oracle: definition of rest. 5 % of the force, in the second that begins a second and a half
  // after the box stopped: before, it swung by a third to nine tenths for good.
  struct Press {
    double size, depth;
  };
  for (const auto& [size, depth] : {Press{0.02, 0.01}, Press{0.01, 0.02}}) {
    INFO("a box of " << size << " m, " << depth << " m deep");
    scene::Scene scene = scene::load_scene(data_file("scenes/liver_probe.yaml"));
    scene.rates.deformation = 250;
    scene.probes[0].shape = scene::BoxShape{Vec3::Constant(size)};
    const session::Assets assets = session::load_assets(scene);
    const auto at = [&](double deep) {
      return Pose{Vec3(-0.02, -0.0645 - size / 2 + deep, 0.013), Quat::Identity()};
    };
    rigs::PressedOrgan organ(scene, assets.organs.at(0), {at(-0.01)});
    double least = 1e9, most = 0;
    for (int period = 1; period <= 1000; ++period) {
      const double way = std::min(period * organ.period() / 1.5, 1.0);
      organ.advance({at(-0.01 + way * (depth + 0.01))});
      if (period <= 750) continue;
      const double force = organ.force(0).norm();
      least = std::min(least, force);
      most = std::max(most, force);
    }
    INFO("force from " << least << " to " << most << " N");
    CHECK(least > 0.5);
    CHECK(most - least < 0.05 * most);
  }
}

TEST_CASE(
    "contact loop: a ball that slides from free onto fixed tissue is not wedged between them") {
  // Oracle: what it feels where all of it lies on fixed tissue, which is most: nothing on the way
  // is a tenth more. Before, up to 80 kN.
  scene::Scene scene = scene::load_scene(data_file("scenes/liver_probe.yaml"));
  scene.rates.deformation = 250;
  const double radius = 0.008, depth = 0.002, skin = 0.0331;
  scene.probes[0].shape = scene::SphereShape{radius};
  const session::Assets assets = session::load_assets(scene);
  const auto at = [&](double deep, double way) {
    return Pose{Vec3(0.012 - way, skin + radius - deep, 0.03), Quat::Identity()};
  };
  rigs::PressedOrgan organ(scene, assets.organs.at(0), {at(-0.02, 0)});
  double most = 0;
  for (int period = 1; period <= 500; ++period) {
    const double pressed = std::min(period / 200.0, 1.0);
    const double slid = std::clamp((period - 200) / 250.0, 0.0, 1.0);
    organ.advance({at(-0.02 + pressed * (depth + 0.02), 0.04 * slid)});
    most = std::max(most, organ.force(0).norm());
  }
  const double end = organ.force(0).norm();
  INFO("at most " << most << " N, at the end " << end);
  CHECK(end > 1);
  CHECK(most < 1.1 * end);
}

TEST_CASE(
    "contact loop: a ball that begins inside is not pushed by fixed tissue on the other side") {
  // Oracle: what it feels in the end, when the wall that is nearest lies on it: before that nothing
  // is a tenth more. The stomach's back is fixed, 3 cm away; it gave 16 N.
  const scene::Scene scene = scene::load_scene(data_file("scenes/stomach_probe.yaml"));
  const session::Assets assets = session::load_assets(scene);
  const Pose inside{Vec3(0.02, 0, 0), Quat::Identity()};
  rigs::PressedOrgan organ(scene, assets.organs.at(0), {inside});
  double most = 0;
  for (double time = 0; time < 3; time += organ.period()) {
    organ.advance({inside});
    most = std::max(most, organ.force(0).norm());
  }
  const double end = organ.force(0).norm();
  INFO("at most " << most << " N, at the end " << end);
  CHECK(end > 0.5);
  CHECK(most < 1.1 * end);
}

TEST_CASE("contact loop: a cone that begins inside comes out, all of it") {
  // Oracle: winding number along its axis, on the surface as it is. It stayed for good: its corners
  // came out, and what lay between them was told by nothing.
  scene::Scene scene = scene::load_scene(data_file("scenes/stomach_probe.yaml"));
  constexpr double kLength = 0.02;
  scene.probes[0].shape = scene::ConeShape{0.002, kLength};
  const session::Assets assets = session::load_assets(scene);
  const Pose inside{Vec3(0.01, -0.012, -0.02), Quat::Identity()};
  rigs::PressedOrgan organ(scene, assets.organs.at(0), {inside});
  geometry::TriangleSurface skin = organ.skin();
  const auto places_inside = [&] {
    for (std::size_t i = 0; i < skin.nodes.size(); ++i) skin.nodes[i] = organ.position(i);
    int count = 0;
    for (int k = 1; k < 40; ++k) {
      const Vec3 place = inside.to_world(k / 40.0 * kLength * Vec3::UnitZ());
      count += geometry::winding_number(place, skin.nodes, skin.triangles) > 0.5;
    }
    return count;
  };
  organ.advance({inside});
  CHECK(places_inside() > 20);
  while (organ.time() < 6) organ.advance({inside});
  CHECK(places_inside() == 0);
}

}  // namespace
}  // namespace palpate::contact_loop
