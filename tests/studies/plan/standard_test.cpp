#include "studies/plan/standard.h"

#include <algorithm>
#include <catch2/catch.hpp>
#include <fstream>
#include <sstream>

#include "modules/core/data_folder.h"
#include "modules/core/error.h"
#include "modules/scene/assets.h"
#include "modules/scene/scene_file.h"
#include "modules/scene/scene_reader.h"
#include "studies/plan/probe_paths.h"
#include "tests/modules/geometry/tetrahedra.h"
#include "tests/studies/chart/folders.h"

namespace palpate::plan {
namespace {

TEST_CASE(
    "standard: a truth judges solids, and walls under round probes if force or surface counts") {
  // Oracle: the definition.
  CHECK(is_judged_by_truth(scene::load_scene(scene::scene_file("liver_solid"))));
  const scene::Scene wall = scene::load_scene(scene::scene_file("stomach_probe"));
  CHECK(is_judged_by_truth(wall));
  scene::Scene boxed = wall;
  boxed.probes[0].shape = scene::BoxShape{};
  CHECK_FALSE(is_judged_by_truth(boxed));
  scene::Scene volume_alone = wall;
  volume_alone.needs.force_error.reset();
  CHECK(is_judged_by_truth(volume_alone));
  volume_alone.needs.surface_error.reset();
  CHECK_FALSE(is_judged_by_truth(volume_alone));
}

TEST_CASE("standard: where no probe touches, nothing is judged by touches") {
  // Oracle: the scene's probe comes to the organ after some 2.5 s.
  const scene::Scene wall = scene::load_scene(scene::scene_file("stomach_probe"));
  PlanOptions options;
  options.seconds = 1;
  CHECK_THROWS_WITH(Standard(wall, options),
                    Catch::Contains("no probe touches the organ in the first 1 s"));
  options.seconds = 3;
  const Standard standard(wall, options);
  CHECK(standard.radius() == Approx(0.008));
  CHECK(standard.held().empty());
}

TEST_CASE("standard: where a probe is held there is one truth, asked once for all its instants") {
  // Oracle: the truth of the last instant alone, the same bits; what the log counts.
  if (geometry::testing::without_gmsh()) return;
  const chart::testing::WorkFolder folder;
  std::filesystem::copy_file(data_file("scenes/meshes/ball.ply"), folder.path / "ball.ply");
  const auto file = folder.path / "scene.yaml";
  std::ofstream(file) << R"(palpate_scene: 1
organs:
  - name: ball
    mesh: {file: ball.ply, nodes: 80}
    fixed:
      - box: {min_m: [-1, -1, -1], max_m: [1, 1, -0.03]}
probes:
  - name: tip
    shape: {sphere: {radius_m: 0.014}}
    device:
      scripted: {start_m: [0, 0, 0.066], moves: [{to_m: [0, 0, 0.062], duration_s: 0.4}, {wait_s: 1}]}
needs: {contents: solid, force_error: 0.5}
)";
  const scene::Scene scene = scene::load_scene(file);
  PlanOptions options;
  options.seconds = 0.6;
  options.touches = 3;
  Standard standard(scene, options);
  std::ostringstream log;
  standard.find(log, [] {});
  INFO(log.str());
  CHECK_THAT(log.str(), Catch::Contains("at 3 instants, 2 of them different"));
  REQUIRE(standard.truths().size() == 3);
  const TrueTouch& first = standard.truths()[0];
  const TrueTouch& last = standard.truths()[2];
  CHECK(std::ranges::is_sorted(standard.held()));
  CHECK(standard.truths()[1].truth.forces == last.truth.forces);
  CHECK(first.truth.forces != last.truth.forces);

  std::vector<std::uint32_t> probes;
  const ProbePaths paths(scene, scene::load_skin(scene.organs[0]), options.seconds);
  const auto question = paths.question_at(last.time, probes);
  const auto alone = truth::force_truth(truth::body_of(scene.organs[0]), question, {});
  REQUIRE(alone.size() == 1);
  CHECK(alone[0].forces == last.truth.forces);
}

}  // namespace
}  // namespace palpate::plan
