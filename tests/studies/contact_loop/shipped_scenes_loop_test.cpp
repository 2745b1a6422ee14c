// Every shipped scene's organ under every kind of tool.
#include <Eigen/Geometry>
#include <catch2/catch.hpp>
#include <random>

#include "modules/core/data_folder.h"
#include "modules/scene/scene_reader.h"
#include "studies/contact_loop/contact_loop.h"
#include "studies/rigs/poked_organ.h"

namespace palpate::contact_loop {
namespace {

/// On the organ's front, nearest to its middle of what a few random lines meet.
Vec3 place_on(const geometry::TriangleSurface& surface) {
  Eigen::AlignedBox3d box;
  for (const Vec3& x : surface.nodes) box.extend(x);
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> share(-0.5, 0.5);
  for (double spread = 0;; spread += 0.02) {
    const Vec3 at =
        box.center() + spread * box.sizes().cwiseProduct(Vec3(share(random), 0, share(random)));
    if (rigs::find_front(surface, at.x(), at.z())) return at;
  }
}

TEST_CASE("contact loop: no tool loses contact with any shipped scene's organ") {
  // Oracle: winding number over all triangles, of the surface each search was made on and of that
  // each advance left, which comes into a mesh at 2.5 m/s (docs/contact.md). Tools, speeds and
  // rates go round over the scenes. (19,362 nodes take minutes.)
  const std::vector<std::string> tools{"ball", "needle", "box", "blade", "mesh"};
  const double radii[] = {1e-3, 8e-3, 2e-3, 5e-4, 4e-3};
  const double rates[] = {50, 100, 250};
  const double speeds[] = {0.1, 2.5, 0.63};
  std::size_t turn = 0;
  long inside = 0;
  for (const char* name :
       {"ball_squeeze", "liver_on_stomach", "liver_probe", "liver_solid", "own_mesh", "press_me",
        "stomach_folded", "stomach_insufflated", "stomach_probe", "liver_touch"}) {
    const auto scene = scene::load_scene(data_file("scenes") / (std::string(name) + ".yaml"));
    const session::Assets assets = session::load_assets(scene);
    const Vec3 place = place_on(assets.organs.at(0).surface);
    for (int of_scene = 0; of_scene < 2; ++of_scene, ++turn) {
      const std::string& tool = tools[turn % tools.size()];
      const LoopCase loop{make_tool(tool, radii[turn / 5 % 5]), speeds[turn / 3 % 3],
                          rates[turn % 3], 250};
      const LoopResult result = run_loop(scene, assets, place, loop);
      INFO(name << ": " << tool << ", case " << turn << ", at " << loop.speed << " m/s, "
                << loop.deformation_hz << " Hz");
      CHECK(result.lost == 0);
      if (tool != "mesh" || loop.speed < 1) CHECK(result.crossings == 0);
      CHECK(result.swallowed == 0);
      CHECK(result.troubles.lost == 0);
      CHECK(result.troubles.truncated == 0);
      inside += result.inside;
    }
  }
  CHECK(inside > 300);  // else nothing was tried
}

}  // namespace
}  // namespace palpate::contact_loop
