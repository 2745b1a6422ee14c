#include "palpate/new_command.h"

#include <catch2/catch.hpp>
#include <sstream>

#include "modules/core/error.h"
#include "modules/geometry/mesh_io.h"
#include "modules/geometry/primitives.h"
#include "modules/scene/scene_reader.h"
#include "palpate/scene_doubts.h"
#include "tests/scratch_folder.h"

using namespace palpate;
using namespace palpate::launcher;
using Catch::Contains;

namespace {

/// A ball of 12 cm, written in units of so many metres, moved aside by a metre.
std::filesystem::path write_ball(const ScratchFolder& folder, double unit, int refinements = 3) {
  auto ball = geometry::make_ball(0.06, refinements);
  for (Vec3& node : ball.nodes) node = (node + Vec3(1, -0.5, 0.2)) / unit;
  geometry::write_surface(ball, folder / "organ.stl");
  return folder / "organ.stl";
}

}  // namespace

TEST_CASE("new: a scene from a mesh can be run, and leaves no doubt") {
  // Oracle: the scene reader and the doubts that `palpate run` has.
  for (const auto& [unit, word] :
       std::vector<std::pair<double, std::string>>{{1e-3, "mm"}, {1e-2, "cm"}, {1, "m"}}) {
    const ScratchFolder folder;
    std::ostringstream out;
    CHECK(new_command({.mesh = write_ball(folder, unit),
                       .output = folder / "a.yaml",
                       .unit = word == "cm" ? "cm" : ""},
                      out) == kExitDone);
    INFO(out.str());
    const auto scene = scene::load_scene(folder / "a.yaml");
    CHECK(scene.organs[0].mesh.unit == word);
    CHECK_THAT(out.str(), Contains("120 x 120 x 120 mm"));
    const auto skins = load_skins(scene);
    CHECK(doubts_about(scene, skins).lines.empty());
    std::vector<std::string> warnings;
    const collision::Approach approach = launcher::motion_of(scene, 0, skins, warnings).approach;
    CHECK(approach.touches_at);
    CHECK(scene.organs[0].tissue.wall_thickness == Approx(0.16 * 0.06).epsilon(0.05));
  }
}

TEST_CASE("new: a guess that is not the only one is said, a size of no organ refused") {
  // Oracle: the ball's size: 12 cm are 12 units of cm, or 12 mm, which no organ has.
  const ScratchFolder folder;
  std::ostringstream out;
  new_command({.mesh = write_ball(folder, 1e-3), .output = folder / "a.yaml", .unit = ""}, out);
  CHECK_THAT(out.str(), Contains("in mm (guessed)"));
  const auto small = write_ball(folder, 3e-3);  // 40 units: 40 mm, or 40 cm
  std::ostringstream two;
  new_command({.mesh = small, .output = folder / "b.yaml", .unit = ""}, two);
  CHECK_THAT(two.str(), Contains("in mm (guessed; in cm it would be 400 mm long)"));
  CHECK_THROWS_WITH(
      new_command({.mesh = write_ball(folder, 1e-6), .output = folder / "c.yaml", .unit = ""}, out),
      Contains("no organ's size in mm, cm or m"));
  CHECK_FALSE(std::filesystem::exists(folder / "c.yaml"));
}

TEST_CASE("new: no scene is overwritten, and a large mesh is resampled") {
  // Oracle: the file's text; the count of nodes.
  const ScratchFolder folder;
  const auto mesh = write_ball(folder, 1, 5);
  folder.write("a.yaml", "mine");
  std::ostringstream out;
  CHECK_THROWS_WITH(new_command({.mesh = mesh, .output = folder / "a.yaml", .unit = ""}, out),
                    Contains("is there already"));
  CHECK(text_in(folder / "a.yaml") == "mine");
  new_command({.mesh = mesh, .output = folder / "b.yaml", .unit = ""}, out);
  CHECK(scene::load_scene(folder / "b.yaml").organs[0].mesh.nodes == 1000);
}
